// Datagrams at the control port of the emulated camera, on arbitrary bytes: the decoder, and what the registers do with
// reads and writes. Promises: a command that is accepted is the same when it is written and read again; registers stay
// readable, and the region stays on the sensor.

#include <stdexcept>

#include "emulators/gige/registers.h"
#include "hil_drivers/gige/protocol/gvcp.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::gige;

/// Executes what needs no socket.
struct Execution {
  Registers& registers;

  void operator()(const wire::Discovery& /*body*/) const {}
  void operator()(const wire::PacketResend& body) const { VBAR_FUZZ_EXPECT(body.first <= body.last); }
  void operator()(const wire::ReadRegisters& body) const {
    for (const std::uint32_t address : body.addresses) (void)registers.read(address, 4);
  }
  void operator()(const wire::ReadMemory& body) const {
    const Registers::Read read = registers.read(body.address, body.count);
    VBAR_FUZZ_EXPECT(read.status != wire::Status::kSuccess || read.bytes.size() == body.count);
  }
  void operator()(const wire::WriteRegisters& body) const {
    for (const auto& [address, value] : body.values) {
      wire::Bytes bytes;
      wire::append_u32(bytes, value);
      (void)registers.write(address, bytes);
    }
  }
  void operator()(const wire::WriteMemory& body) const { (void)registers.write(body.address, body.bytes); }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // One camera for all inputs: its state is that of a device which has heard them all.
  static Registers registers({}, 0x7F000001);
  const wire::ByteSpan bytes(data, size);
  try {
    (void)wire::decode_acknowledge(bytes);
  } catch (const std::invalid_argument&) {
  }
  const auto decoded = wire::decode_command(bytes);
  const auto* message = std::get_if<wire::CommandMessage>(&decoded);
  if (message == nullptr) return 0;
  const auto again = wire::decode_command(wire::encode_command(*message));
  VBAR_FUZZ_EXPECT(std::holds_alternative<wire::CommandMessage>(again) &&
                   std::get<wire::CommandMessage>(again) == *message);
  std::visit(Execution{registers}, message->body);
  using enum FeatureId;
  VBAR_FUZZ_EXPECT(registers.integer(kOffsetX) + registers.integer(kWidth) <= registers.integer(kSensorWidth));
  VBAR_FUZZ_EXPECT(registers.integer(kOffsetY) + registers.integer(kHeight) <= registers.integer(kSensorHeight));
  VBAR_FUZZ_EXPECT(registers.value(kExposureTime) > 0.0 && registers.value(kFrameRate) > 0.0);
  return 0;
}
