#include "emulators/gige/device.h"

#include <array>
#include <optional>
#include <stdexcept>

#include <boost/asio/steady_timer.hpp>
#include <fmt/format.h>

#include "emulators/gige/registers.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::gige {

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using wire::Bytes;
using wire::ByteSpan;
using wire::Status;

asio::ip::address_v4 address_of(const std::string& text) {
  error_code error;
  const auto address = asio::ip::make_address_v4(text, error);
  if (error) throw std::invalid_argument(fmt::format("\"{}\" is not an IPv4 address", text));
  return address;
}

/// Owner that no host is: an address of the network that is reserved for documentation.
const udp::endpoint kOtherOwner(asio::ip::make_address_v4("192.0.2.1"), 1);

}  // namespace

/// The control channel: who may do what, and what a write causes.
class Device::Control {
 public:
  Control(asio::io_context& context, const Settings& settings, Expose expose)
      : context_(context),
        address_(address_of(settings.address)),
        registers_(settings.description, address_.to_uint()),
        sender_(context, address_, settings.seed),
        acquisition_(context, registers_, sender_, settings.description, settings.pace, settings.readout_s,
                     std::move(expose)),
        socket_(context),
        heartbeat_(context) {
    error_code error;
    socket_.open(udp::v4(), error);
    if (!error) socket_.bind(udp::endpoint(address_, settings.port), error);
    if (!error) socket_.non_blocking(true, error);
    if (error)
      throw std::runtime_error(
          fmt::format("UDP port {} of {} is not available: {}", settings.port, settings.address, error.message()));
    receive();
  }

  void close() {
    acquisition_.stop();
    sender_.close();
    heartbeat_.cancel();
    error_code ignored;
    socket_.close(ignored);
  }

  void set_busy(bool busy) {
    release();
    if (busy) {
      owner_ = kOtherOwner;
      registers_.set_word(bootstrap::kControlPrivilege, bootstrap::kControlAccess);
    }
  }

  void set_away(bool away) {
    is_away_ = away;
    sender_.set_silent(away);
  }

  Registers& registers() { return registers_; }
  StreamSender& sender() { return sender_; }
  Acquisition& acquisition() { return acquisition_; }
  [[nodiscard]] bool is_owned() const { return owner_.has_value(); }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  [[nodiscard]] Statistics statistics() const {
    Statistics all = statistics_;
    all.acquisition = acquisition_.statistics();
    all.stream = sender_.statistics();
    return all;
  }

  std::chrono::milliseconds answer_delay{0};

 private:
  void receive() {
    // The handlers of a socket that was closed find no control any more.
    socket_.async_receive_from(asio::buffer(buffer_), sender_of_command_,
                               [this, alive = std::weak_ptr<int>(alive_)](const error_code& error, std::size_t n) {
                                 if (alive.expired() || error == asio::error::operation_aborted) return;
                                 if (!error && !is_away_) handle(ByteSpan(buffer_).first(n), sender_of_command_);
                                 receive();
                               });
  }

  void handle(ByteSpan datagram, const udp::endpoint& sender) {
    const auto decoded = wire::decode_command(datagram);
    if (std::holds_alternative<wire::ForeignDatagram>(decoded)) {
      ++statistics_.foreign_datagrams;
      return;
    }
    ++statistics_.commands;
    if (owner_ == sender) restart_heartbeat();
    if (const auto* refused = std::get_if<wire::RefusedCommand>(&decoded)) {
      ++statistics_.commands_refused;
      if (refused->acknowledge) answer({refused->status, refused->command, refused->id, {}}, sender);
      return;
    }
    const auto& message = std::get<wire::CommandMessage>(decoded);
    const std::uint16_t number = wire::command_number(message.body);
    // A command repeated for a lost or late acknowledge is not executed again.
    if (last_.sender == sender && last_.id == message.id && last_.command == number && !last_.acknowledge.empty())
      return send_later(last_.acknowledge, sender);
    wire::Acknowledge acknowledge{Status::kSuccess, number, message.id, {}};
    std::visit([&](const auto& body) { execute(body, sender, acknowledge); }, message.body);
    if (acknowledge.status != Status::kSuccess) ++statistics_.commands_refused;
    // Packets are the answer to a request for them.
    if (!message.acknowledge || std::holds_alternative<wire::PacketResend>(message.body)) return;
    last_ = {sender, message.id, number, answer(acknowledge, sender)};
  }

  Bytes answer(const wire::Acknowledge& acknowledge, const udp::endpoint& receiver) {
    Bytes bytes = wire::encode_acknowledge(acknowledge);
    send_later(bytes, receiver);
    return bytes;
  }

  void send_later(const Bytes& bytes, const udp::endpoint& receiver) {
    if (answer_delay.count() == 0) return transmit(bytes, receiver);
    auto timer = std::make_shared<asio::steady_timer>(context_, answer_delay);
    timer->async_wait([this, timer, bytes, receiver, alive = std::weak_ptr<int>(alive_)](const error_code& error) {
      if (!error && !alive.expired()) transmit(bytes, receiver);
    });
  }

  void transmit(const Bytes& bytes, const udp::endpoint& receiver) {
    if (is_away_) return;
    error_code ignored;
    socket_.send_to(asio::buffer(bytes), receiver, 0, ignored);
  }

  [[nodiscard]] bool may_read(const udp::endpoint& sender) const {
    const bool is_exclusive = (registers_.word(bootstrap::kControlPrivilege) & bootstrap::kExclusiveAccess) != 0;
    return !owner_ || !is_exclusive || *owner_ == sender;
  }

  void execute(const wire::Discovery& /*command*/, const udp::endpoint& /*sender*/, wire::Acknowledge& acknowledge) {
    acknowledge.body = registers_.read(0, bootstrap::kDiscoveryBytes).bytes;
  }

  void execute(const wire::ReadRegisters& command, const udp::endpoint& sender, wire::Acknowledge& acknowledge) {
    for (const std::uint32_t address : command.addresses) {
      // Who owns the camera may be asked by all.
      const bool is_public = address == bootstrap::kControlPrivilege;
      const Registers::Read read = !is_public && !may_read(sender) ? Registers::Read{Status::kAccessDenied, {}}
                                   : address % 4 != 0              ? Registers::Read{Status::kBadAlignment, {}}
                                                                   : registers_.read(address, 4);
      acknowledge.status = read.status;
      if (read.status != Status::kSuccess) return;
      acknowledge.body.insert(acknowledge.body.end(), read.bytes.begin(), read.bytes.end());
    }
  }

  void execute(const wire::ReadMemory& command, const udp::endpoint& sender, wire::Acknowledge& acknowledge) {
    const Registers::Read read =
        may_read(sender) ? registers_.read(command.address, command.count) : Registers::Read{Status::kAccessDenied, {}};
    acknowledge.status = read.status;
    if (read.status != Status::kSuccess) return;
    wire::append_u32(acknowledge.body, command.address);
    acknowledge.body.insert(acknowledge.body.end(), read.bytes.begin(), read.bytes.end());
  }

  void execute(const wire::WriteRegisters& command, const udp::endpoint& sender, wire::Acknowledge& acknowledge) {
    std::uint16_t count = 0;
    for (const auto& [address, value] : command.values) {
      Bytes bytes;
      wire::append_u32(bytes, value);
      acknowledge.status = write(address, bytes, sender);
      if (acknowledge.status != Status::kSuccess) break;
      ++count;
    }
    append_count(count, acknowledge);
  }

  void execute(const wire::WriteMemory& command, const udp::endpoint& sender, wire::Acknowledge& acknowledge) {
    acknowledge.status = write(command.address, command.bytes, sender);
    const bool is_written = acknowledge.status == Status::kSuccess;
    append_count(is_written ? static_cast<std::uint16_t>(command.bytes.size()) : std::uint16_t{0}, acknowledge);
  }

  static void append_count(std::uint16_t count, wire::Acknowledge& acknowledge) {
    wire::append_u16(acknowledge.body, 0);
    wire::append_u16(acknowledge.body, count);
  }

  void execute(const wire::PacketResend& command, const udp::endpoint& sender, wire::Acknowledge& /*acknowledge*/) {
    // By the owner's host only: the request comes from the socket of the stream.
    if (owner_ && owner_->address() == sender.address() && command.channel == 0) sender_.resend(command);
  }

  Status write(std::uint32_t address, ByteSpan bytes, const udp::endpoint& sender) {
    if (address % 4 != 0) return Status::kBadAlignment;
    if (address == bootstrap::kControlPrivilege && bytes.size() == 4) return claim(wire::load_u32(bytes, 0), sender);
    if (owner_ != sender) return Status::kAccessDenied;
    if (address == bootstrap::kTimestampControl && bytes.size() == 4) return control_clock(wire::load_u32(bytes, 0));
    const Registers::Written written = registers_.write(address, bytes);
    if (written.status != Status::kSuccess) return written.status;
    if (written.feature)
      act(*written.feature);
    else
      apply_channel(address, bytes);
    return Status::kSuccess;
  }

  Status control_clock(std::uint32_t command) {
    if (command != bootstrap::kLatchTimestamp) return Status::kInvalidParameter;  // this clock cannot be reset
    const std::uint64_t ticks = acquisition_.ticks();
    registers_.set_word(bootstrap::kTimestampHigh, static_cast<std::uint32_t>(ticks >> 32U));
    registers_.set_word(bootstrap::kTimestampLow, static_cast<std::uint32_t>(ticks));
    return Status::kSuccess;
  }

  Status claim(std::uint32_t privilege, const udp::endpoint& sender) {
    if (owner_ && owner_ != sender) return Status::kAccessDenied;
    if ((privilege & (bootstrap::kControlAccess | bootstrap::kExclusiveAccess)) == 0) {
      if (owner_) release();
      return Status::kSuccess;
    }
    owner_ = sender;
    registers_.set_word(bootstrap::kControlPrivilege, privilege);
    restart_heartbeat();
    return Status::kSuccess;
  }

  void release() {
    acquisition_.stop();
    sender_.clear();
    heartbeat_.cancel();
    owner_.reset();
    for (const std::uint32_t address :
         {bootstrap::kControlPrivilege, bootstrap::kStreamPort, bootstrap::kStreamDestination})
      registers_.set_word(address, 0);
    sender_.set_channel({});
  }

  void restart_heartbeat() {
    heartbeat_.expires_after(std::chrono::milliseconds(registers_.word(bootstrap::kHeartbeatMs)));
    heartbeat_.async_wait([this, alive = std::weak_ptr<int>(alive_)](const error_code& error) {
      if (error || alive.expired()) return;
      // A long exposure keeps this thread from reading: what the owner sent meanwhile waits in the socket.
      error_code ignored;
      if (socket_.available(ignored) > 0) return restart_heartbeat();
      ++statistics_.owners_expired;
      release();
    });
  }

  void act(FeatureId feature) {
    switch (feature) {
      case FeatureId::kAcquisitionStart:
        return acquisition_.start();
      case FeatureId::kAcquisitionStop:
        return acquisition_.stop();
      case FeatureId::kTriggerSoftware:
        if (registers_.integer(FeatureId::kTriggerSource) == kSoftwareSource) acquisition_.trigger();
        return;
      default:
        return;
    }
  }

  void apply_channel(std::uint32_t address, ByteSpan bytes) {
    using namespace bootstrap;
    StreamSender::Channel channel;
    channel.destination = {asio::ip::address_v4(registers_.word(kStreamDestination)),
                           static_cast<std::uint16_t>(registers_.word(kStreamPort))};
    channel.packet_size = registers_.word(kPacketSize) & 0xFFFF;
    channel.packet_delay = std::chrono::nanoseconds(registers_.word(kPacketDelay));
    sender_.set_channel(channel);
    if (address == kPacketSize && (wire::load_u32(bytes, 0) & kFireTestPacket) != 0)
      sender_.send_test_packet((registers_.word(kPacketSize) & kDoNotFragment) != 0);
  }

  static constexpr std::uint32_t kSoftwareSource = 7;

  struct LastCommand {
    udp::endpoint sender;
    std::uint16_t id = 0, command = 0;
    Bytes acknowledge;
  };

  asio::io_context& context_;
  asio::ip::address_v4 address_;
  Registers registers_;
  StreamSender sender_;
  Acquisition acquisition_;
  udp::socket socket_;
  asio::steady_timer heartbeat_;
  std::array<std::uint8_t, 2048> buffer_{};
  udp::endpoint sender_of_command_;
  std::optional<udp::endpoint> owner_;
  LastCommand last_;
  bool is_away_ = false;
  Statistics statistics_;
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);
};

Device::Device(asio::io_context& context, const Settings& settings, Expose expose)
    : control_(std::make_unique<Control>(context, settings, std::move(expose))) {}

Device::~Device() {
  control_->close();
}

void Device::set_packet_faults(const PacketFaults& faults) {
  control_->sender().set_faults(faults);
}
void Device::set_answer_delay(std::chrono::milliseconds delay) {
  control_->answer_delay = delay;
}
void Device::set_away(bool away) {
  control_->set_away(away);
}
void Device::set_busy(bool busy) {
  control_->set_busy(busy);
}
void Device::damage_xml(bool damaged) {
  control_->registers().damage_xml(damaged);
}
void Device::set_exposure_factor(double factor) {
  control_->acquisition().set_exposure_factor(factor);
}
void Device::refuse_region(bool refused) {
  control_->registers().refuse_region(refused);
}
void Device::ignore_triggers(int count) {
  control_->acquisition().ignore_triggers(count);
}
void Device::lose_frames(int count) {
  control_->acquisition().lose_frames(count);
}
void Device::repeat_frames(int count) {
  control_->acquisition().repeat_frames(count);
}
void Device::delay_frames(int count, bool alone) {
  control_->acquisition().delay_frames(count, alone);
}
void Device::set_payload_type(wire::PayloadType type) {
  control_->acquisition().set_payload_type(type);
}
Device::Statistics Device::statistics() const {
  return control_->statistics();
}
std::uint16_t Device::port() const {
  return control_->port();
}
bool Device::is_owned() const {
  return control_->is_owned();
}

PlacedDevice device_on_free_address(boost::asio::io_context& context, Device::Settings settings,
                                    const std::string& network, const Expose& expose) {
  constexpr int kFirstHost = 1, kLastHost = 254;
  for (int host = kFirstHost;; ++host) {
    settings.address = fmt::format("{}.{}", network, host);
    try {
      return {settings.address, std::make_unique<Device>(context, settings, expose)};
    } catch (const std::runtime_error&) {
      if (host == kLastHost) throw;
    }
  }
}

std::string drawn_serial(std::uint64_t seed, const std::string& stream) {
  engine::RandomStream random(seed, stream);
  return fmt::format("{:08}", 10'000'000 + random.bits() % 90'000'000);
}

}  // namespace vbar::gige
