// A receiver's command port on arbitrary bytes. The first byte chooses:
//
//   bit 0   0: raw bytes in pieces. 1: records of  command number, body length, body, sent as binary commands with a
//           right CRC (which a fuzzer does not guess)
//   bit 1   the receiver hears a sky's first blocks in between
//
// Promises: whatever comes, the answers and logs that leave are whole (the flight decoder finds no wrong checksum), at
// most 30 logs are kept, and the receiver still answers a command.

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "emulators/grand/receiver/receiver.h"
#include "fsw/gnss/oem_stream.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/gnss_scene.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace {

using namespace vbar;
using grand::bench::Receiver;

constexpr std::array<unsigned, 15> kCommands{1, 4, 15, 18, 19, 20, 36, 38, 50, 102, 269, 377, 613, 1246, 7};

const std::shared_ptr<const twins::gnss::Constellation>& constellation() {
  static const auto all = test::constellation(1);
  return all;
}

std::string answer_to(Receiver& receiver, int port, std::string_view line) {
  receiver.listen(port, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, receiver.baud(port));
  std::string said;
  for (int k = 0; k < 3000 && receiver.busy(); ++k) {
    receiver.idle(fsw::Duration{100'000'000});
    const auto bytes = receiver.speak(port);
    said.append(bytes.begin(), bytes.end());
  }
  return said;
}

void feed(Receiver& receiver, std::span<const std::uint8_t> input, bool binary) {
  while (!input.empty()) {
    if (binary) {
      if (input.size() < 2) return;
      const unsigned id = kCommands[input[0] % kCommands.size()];
      const auto body = input.subspan(2, std::min<std::size_t>(input[1] % 64U, input.size() - 2));
      receiver.listen(0, fsw::gnss::test::message(id, {body.begin(), body.end()}, {}), receiver.baud(0));
      input = input.subspan(2 + body.size());
    } else {
      const auto piece = input.first(std::min<std::size_t>(input.size(), 97));
      receiver.listen(0, piece, receiver.baud(0));
      input = input.subspan(piece.size());
    }
    receiver.idle(fsw::Duration{20'000'000});
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> input(data, std::min<std::size_t>(size, 4096));
  if (input.empty()) return 0;
  const bool binary = (input[0] & 1U) != 0;
  const bool flies = (input[0] & 2U) != 0;
  grand::bench::ReceiverSettings settings;
  settings.line.boot_s = 0.0;
  Receiver receiver(settings, constellation(), 1, "fuzz");
  receiver.power(true);
  receiver.idle(fsw::Duration{1'000'000});
  feed(receiver, input.subspan(1), binary);
  for (int k = 0; flies && k < 12; ++k) {
    grand::bench::RfBlock block;
    block.begin = test::kGnssStart + fsw::Duration{k * grand::bench::RfBlock::kLength.ns};
    receiver.advance(block);
  }
  fsw::gnss::OemStream stream;
  for (int k = 0; k < 4000 && receiver.busy(); ++k) {
    receiver.idle(fsw::Duration{1'000'000'000});
    for (const std::uint8_t byte : receiver.speak(0)) static_cast<void>(stream.push(byte));
  }
  VBAR_FUZZ_EXPECT(!receiver.busy());
  VBAR_FUZZ_EXPECT(stream.counters().bad_checksum == 0);
  receiver.idle(fsw::Duration{2'000'000'000});  // an unfinished command is given up
  static_cast<void>(answer_to(receiver, 0, "\r\n\r\n"));
  const std::string answer = answer_to(receiver, 0, "CLOCKADJUST ENABLE\r\n");
  VBAR_FUZZ_EXPECT(answer == "<OK\r\n[COM1]");
  return 0;
}
