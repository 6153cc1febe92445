#include "pil_bridge/telecommand_security.h"

#include <algorithm>
#include <ctime>
#include <span>
#include <utility>
#include <vector>

#include "boards/posix/telecommand_key_file.h"

namespace vbar::pil {
namespace {

namespace packets = fsw::packets;

std::uint64_t sequence_now() {
  timespec now{};
  if (::clock_gettime(CLOCK_REALTIME, &now) != 0)
    throw FlightComputerError("the clock of this computer cannot be read");
  return packets::sequence_at(now.tv_sec, now.tv_nsec);
}

class Authenticated final : public FlightComputer {
 public:
  Authenticated(std::unique_ptr<FlightComputer> computer, const packets::TelecommandSecurity& security)
      : computer_(std::move(computer)), hmac_(security.key), index_(security.index), sequence_(security.sequence) {}

  StepResult step(std::uint32_t step, std::span<const Packet> received) override {
    std::vector<Packet> all(received.begin(), received.end());
    for (Packet& packet : all) secure(packet);
    return computer_->step(step, all);
  }
  [[nodiscard]] std::vector<std::uint8_t> snapshot() override { return computer_->snapshot(); }
  void restore(std::span<const std::uint8_t> snapshot) override { computer_->restore(snapshot); }
  [[nodiscard]] LinkStatistics statistics() const override { return computer_->statistics(); }
  [[nodiscard]] std::string description() const override { return computer_->description(); }
  void close() override { computer_->close(); }

 private:
  /// Leaves a packet unchanged that is not a telecommand, or is damaged: the flight software refuses the latter.
  void secure(Packet& packet) {
    const auto view = packets::parse_packet(packet);
    if (!view.ok() || !packets::is_telecommand_apid(view.value().header.apid)) return;
    sequence_ = std::max(sequence_ + 1, sequence_now());
    Packet secured(packets::kMaxPacketBytes);
    const auto size = packets::write_secured(packet, hmac_, index_, sequence_, secured);
    if (!size.ok())
      throw FlightComputerError("a telecommand of " + std::to_string(packet.size()) +
                                " bytes has no room for a security trailer");
    secured.resize(size.value());
    packet = std::move(secured);
  }

  std::unique_ptr<FlightComputer> computer_;
  packets::HmacSha256 hmac_;
  std::uint16_t index_;
  std::uint64_t sequence_;
};

}  // namespace

packets::TelecommandSecurity read_telecommand_security(const std::string& file) {
  packets::TelecommandSecurity security;
  const char* const fault = boards::posix::read_telecommand_key(file.c_str(), security);
  if (fault != nullptr) {
    throw FlightComputerError("flight_computer.telecommand_key_file '" + file + "': " + fault +
                              "; accepted: a file of 64 hexadecimal digits that its owner alone may read");
  }
  return security;
}

std::unique_ptr<FlightComputer> make_authenticated(std::unique_ptr<FlightComputer> computer,
                                                   const packets::TelecommandSecurity& security) {
  return std::make_unique<Authenticated>(std::move(computer), security);
}

}  // namespace vbar::pil
