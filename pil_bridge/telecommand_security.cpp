#include "pil_bridge/telecommand_security.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host_sim/io/file_descriptor.h"

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
  const auto refuse = [&](const std::string& found) {
    throw FlightComputerError("flight_computer.telecommand_key_file '" + file + "': " + found +
                              "; accepted: a file of 64 hexadecimal digits that its owner alone may read (chmod 600)");
  };
  const io::FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK));
  if (fd.get() < 0) refuse(std::strerror(errno));
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0 || !S_ISREG(status.st_mode)) refuse("is not a file");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) refuse("is accessible to others than its owner");
  std::array<char, 128> text{};
  const ssize_t size = ::read(fd.get(), text.data(), text.size());
  if (size < 0) refuse(std::strerror(errno));
  const auto key = packets::parse_telecommand_key(std::span(text).first(static_cast<std::size_t>(size)));
  if (static_cast<std::size_t>(size) == text.size()) refuse("has more than 64 digits");
  if (key.status() == fsw::Status::kInvalidArgument) refuse("has characters that are not hexadecimal digits");
  if (!key.ok())
    refuse(key.status() == fsw::Status::kTooShort ? "has fewer than 64 digits" : "has more than 64 digits");
  return {.key = key.value(), .index = packets::kHostKeyIndex, .sequence = sequence_now()};
}

std::unique_ptr<FlightComputer> make_authenticated(std::unique_ptr<FlightComputer> computer,
                                                   const packets::TelecommandSecurity& security) {
  return std::make_unique<Authenticated>(std::move(computer), security);
}

}  // namespace vbar::pil
