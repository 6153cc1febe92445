// Lines of Zaber's protocol with arbitrary contents. Promise: a command or message that is the same after a turn
// through encoder and decoder, or one WireError; the emulated controller answers any sequence of lines with valid
// replies.

#include <string>

#include "emulators/zaber/device.h"
#include "hil_drivers/wire/bytes.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::zaber;
  double now_s = 0.0;
  Device device({1, {AxisSettings{}, AxisSettings{}}, 1}, [&] { return now_s; });
  vbar::wire::LineBuffer lines;
  lines.append({data, size});
  try {
    while (const auto line = lines.next()) {
      now_s += 0.1;
      for (const std::string& reply : device.answer(*line)) {
        const Message message = decode_message(reply);
        VBAR_FUZZ_EXPECT(message.kind == MessageKind::kReply && encode(message) == reply);
      }
      try {
        const Command command = decode_command(*line);
        VBAR_FUZZ_EXPECT(command.text.find(':') != std::string::npos || command.text.size() >= 256 ||
                         decode_command(encode(command)) == command);
      } catch (const vbar::wire::WireError&) {
      }
      try {
        const Message message = decode_message(*line);
        VBAR_FUZZ_EXPECT(message.data.find(':') != std::string::npos ||
                         message.warning.find(':') != std::string::npos || message.data.size() >= 256 ||
                         decode_message(encode(message)) == message);
      } catch (const vbar::wire::WireError&) {
      }
    }
  } catch (const vbar::wire::WireError&) {
  }
  return 0;
}
