#include "hil_drivers/external/exchange.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"

namespace vbar::external {
namespace {

using fsw::packets::Apid;
using fsw::packets::PacketHeader;
using fsw::packets::PacketView;
using twins::Packet;

template <class Values, class Numbers>
void copy_to(const Values& values, Numbers& numbers) {
  std::copy(values.begin(), values.end(), numbers);
}

fsw::Vector3 vector_of(const double (&numbers)[3]) {
  return {numbers[0], numbers[1], numbers[2]};
}

vbar::true_earth earth_message(const fsw::Matrix3& R_itrf_gcrf) {
  vbar::true_earth message{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) message.R_itrf_gcrf[3 * row + column] = R_itrf_gcrf(row, column);
  return message;
}

fsw::Matrix3 rotation_of(const vbar::true_earth& message) {
  fsw::Matrix3 R_itrf_gcrf;
  for (int k = 0; k < 9; ++k) R_itrf_gcrf(k / 3, k % 3) = message.R_itrf_gcrf[k];
  return R_itrf_gcrf;
}

vbar::true_state state_message(const twins::SpacecraftTruth& truth) {
  vbar::true_state message{};
  copy_to(truth.orbit.position_eci, message.position_eci);
  copy_to(truth.orbit.velocity_eci, message.velocity_eci);
  if (truth.acceleration_eci) copy_to(*truth.acceleration_eci, message.acceleration_eci);
  if (!truth.attitude) return message;
  message.has_attitude = 1;
  const auto& q = truth.attitude->q_body_eci;
  copy_to(std::array{q.w(), q.x(), q.y(), q.z()}, message.q_body_eci);
  copy_to(truth.attitude->rate_body, message.rate_body);
  if (truth.angular_acceleration_body) copy_to(*truth.angular_acceleration_body, message.angular_acceleration_body);
  return message;
}

twins::SpacecraftTruth spacecraft_of(const vbar::true_state& message, std::string name) {
  twins::SpacecraftTruth truth;
  truth.name = std::move(name);
  truth.orbit.position_eci = vector_of(message.position_eci);
  truth.orbit.velocity_eci = vector_of(message.velocity_eci);
  truth.acceleration_eci = vector_of(message.acceleration_eci);
  if (message.has_attitude == 0) return truth;
  const double* const q = message.q_body_eci;
  truth.attitude.emplace();
  truth.attitude->q_body_eci = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  truth.attitude->rate_body = vector_of(message.rate_body);
  truth.angular_acceleration_body = vector_of(message.angular_acceleration_body);
  return truth;
}

Packet opening_packet(PacketHeader header, const Opening& opening) {
  vbar::source_start message{};
  if (opening.name.size() >= sizeof message.name)
    throw std::runtime_error(fmt::format("its name has {} characters; a sensor in another process may have {}",
                                         opening.name.size(), sizeof message.name - 1));
  message.seed = opening.seed;
  std::copy(opening.name.begin(), opening.name.end(), message.name);
  header.spacecraft = opening.spacecraft;
  header.unit = opening.unit;
  return packet_of(header, message);
}

Packet command_packet(const PacketHeader& header, const Command& command) {
  vbar::source_command message{};
  if (command.packet.size() > sizeof message.packet)
    throw std::runtime_error(
        fmt::format("a command of {} bytes, more than {}", command.packet.size(), sizeof message.packet));
  message.effective_ns = command.effective.ns;
  message.count = static_cast<std::int32_t>(command.packet.size());
  std::copy(command.packet.begin(), command.packet.end(), message.packet);
  return packet_of(header, message);
}

std::string text_of(const vbar::source_start& message) {
  const auto end = std::find(std::begin(message.name), std::end(message.name), std::uint8_t{0});
  if (end == std::end(message.name)) throw std::runtime_error("a source_start whose name has no end");
  return {std::begin(message.name), end};
}

/// Takes the parts of a batch out of its packets.
class BatchReader {
 public:
  explicit BatchReader(const SpacecraftNumbers& numbers) : numbers_(numbers) {}

  void take(const PacketView& packet) {
    switch (packet.header.apid) {
      case Apid::kSourceStart:
        batch_.opening = opening(packet);
        return;
      case Apid::kSourceCommand:
        batch_.commands.push_back(command(packet));
        return;
      case Apid::kTrueEarth:
        truth().R_itrf_gcrf = rotation_of(decoded<vbar::true_earth>(packet));
        return;
      case Apid::kTrueState:
        truth().spacecraft.push_back(
            spacecraft_of(decoded<vbar::true_state>(packet), numbers_.name_of(packet.header.spacecraft)));
        return;
      case Apid::kTick:
        static_cast<void>(decoded<vbar::tick>(packet));
        batch_.time = packet.header.time;
        has_tick_ = true;
        return;
      default:
        throw std::runtime_error(
            fmt::format("a packet of APID {:#05x} in a batch for a sensor", static_cast<unsigned>(packet.header.apid)));
    }
  }

  [[nodiscard]] Batch finish() {
    if (!has_tick_) throw std::runtime_error("a batch for a sensor without a tick");
    if (batch_.truth) batch_.truth->time = batch_.time;
    return std::move(batch_);
  }

 private:
  template <class Message>
  static Message decoded(const PacketView& packet) {
    const auto message = fsw::packets::decode<Message>(packet);
    if (!message.ok())
      throw std::runtime_error(fmt::format("the message of APID {:#05x} is that of another version of vbar.lcm",
                                           static_cast<unsigned>(packet.header.apid)));
    return message.value();
  }

  static Opening opening(const PacketView& packet) {
    const auto message = decoded<vbar::source_start>(packet);
    return {text_of(message), message.seed, packet.header.spacecraft, packet.header.unit};
  }

  static Command command(const PacketView& packet) {
    const auto message = decoded<vbar::source_command>(packet);
    const auto count = static_cast<std::size_t>(std::max(message.count, 0));
    if (count > sizeof message.packet) throw std::runtime_error("a command longer than its packet");
    return {Packet(message.packet, message.packet + count), fsw::GpsTime{message.effective_ns}};
  }

  twins::TruthSnapshot& truth() {
    if (!batch_.truth) batch_.truth.emplace();
    return *batch_.truth;
  }

  const SpacecraftNumbers& numbers_;
  Batch batch_;
  bool has_tick_ = false;
};

/// Takes the parts of a truth out of the packets of an answer.
class TruthReader {
 public:
  TruthReader(fsw::GpsTime time, const SpacecraftNumbers& numbers) : numbers_(numbers) { stated_.truth.time = time; }

  void take(const PacketView& packet) {
    const bool is_state = packet.header.apid == Apid::kTrueState;
    if (!is_state && packet.header.apid != Apid::kTrueEarth)
      throw std::runtime_error(fmt::format("a packet of APID {:#05x}, which is neither a true_state nor a true_earth",
                                           static_cast<unsigned>(packet.header.apid)));
    if (packet.header.time != stated_.truth.time)
      throw std::runtime_error(fmt::format("a packet of GPS time {} ns, and {} ns was asked for", packet.header.time.ns,
                                           stated_.truth.time.ns));
    is_state ? take_state(packet) : take_earth(packet);
  }

  [[nodiscard]] StatedTruth finish() { return std::move(stated_); }

 private:
  template <class Message>
  static Message decoded(const PacketView& packet, std::string_view name) {
    const auto message = fsw::packets::decode<Message>(packet);
    if (!message.ok())
      throw std::runtime_error(fmt::format("a {} of another size or type, or with a number that is not finite", name));
    return message.value();
  }

  void take_state(const PacketView& packet) {
    const std::string name = numbers_.name_of(packet.header.spacecraft);
    if (!numbers_.number_of(name))
      throw std::runtime_error(fmt::format("a true_state of {}, which the mission does not have", name));
    if (stated_.truth.find(name) != nullptr)
      throw std::runtime_error(fmt::format("a second true_state of the spacecraft {}", name));
    stated_.truth.spacecraft.push_back(spacecraft_of(decoded<vbar::true_state>(packet, "true_state"), name));
  }

  void take_earth(const PacketView& packet) {
    if (stated_.has_earth) throw std::runtime_error("a second true_earth");
    stated_.truth.R_itrf_gcrf = rotation_of(decoded<vbar::true_earth>(packet, "true_earth"));
    stated_.has_earth = true;
  }

  const SpacecraftNumbers& numbers_;
  StatedTruth stated_;
};

/// Returns true if the payload is a valid message of the packet's APID.
bool holds_its_message(const PacketView& packet) {
  bool is_valid = false;
  fsw::packets::for_each_message([&]<class Message>() {
    if (fsw::packets::MessageTraits<Message>::kApid == packet.header.apid)
      is_valid = fsw::packets::decode<Message>(packet).ok();
  });
  return is_valid;
}

}  // namespace

std::optional<std::uint8_t> SpacecraftNumbers::number_of(std::string_view name) const {
  const auto found = std::ranges::find(known_, name, &Known::name);
  return found == known_.end() ? std::nullopt : std::optional(found->number);
}

std::string SpacecraftNumbers::name_of(std::uint8_t number) const {
  const auto found = std::ranges::find(known_, number, &Known::number);
  return found == known_.end() ? fmt::format("spacecraft {}", number) : found->name;
}

SpacecraftNumbers numbers_of(const mission::Mission& mission) {
  SpacecraftNumbers numbers;
  for (const mission::Spacecraft& spacecraft : mission.spacecraft)
    if (spacecraft.number != mission::kNoSpacecraftNumber) numbers.add(spacecraft.name, spacecraft.number);
  return numbers;
}

std::vector<Packet> packets_of(const Batch& batch, std::int64_t step, const SpacecraftNumbers& numbers) {
  PacketHeader header;
  header.time = batch.time;
  std::vector<Packet> packets;
  if (batch.opening) packets.push_back(opening_packet(header, *batch.opening));
  for (const Command& command : batch.commands) packets.push_back(command_packet(header, command));
  if (batch.truth) {
    twins::TruthSnapshot truth = *batch.truth;
    truth.time = batch.time;
    for (Packet& packet : packets_of(truth, numbers)) packets.push_back(std::move(packet));
  }
  vbar::tick tick{};
  tick.step = step;
  packets.push_back(packet_of(header, tick));
  return packets;
}

std::vector<Packet> packets_of(const twins::TruthSnapshot& truth, const SpacecraftNumbers& numbers) {
  PacketHeader header;
  header.time = truth.time;
  std::vector<Packet> packets{packet_of(header, earth_message(truth.R_itrf_gcrf))};
  for (const twins::SpacecraftTruth& one : truth.spacecraft) {
    const auto number = numbers.number_of(one.name);
    if (!number) throw std::runtime_error(fmt::format("the spacecraft \"{}\" has no number", one.name));
    header.spacecraft = *number;
    packets.push_back(packet_of(header, state_message(one)));
  }
  return packets;
}

std::vector<Packet> packets_of(Answer answer, fsw::GpsTime time) {
  vbar::source_answer message{};
  message.status = answer.is_failed ? vbar::source_answer::kFailed : vbar::source_answer::kReady;
  message.available_ns = answer.available.ns;
  message.next_epoch_ns = answer.next_epoch ? answer.next_epoch->ns : 0;
  PacketHeader header;
  header.time = time;
  answer.packets.push_back(packet_of(header, message));
  return std::move(answer.packets);
}

Batch batch_of(std::span<const Packet> packets, const SpacecraftNumbers& numbers) {
  BatchReader reader(numbers);
  for (const Packet& bytes : packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) throw std::runtime_error(fmt::format("{} bytes that are no packet", bytes.size()));
    reader.take(packet.value());
  }
  return reader.finish();
}

Answer answer_of(std::vector<Packet> packets) {
  const auto is_answer = [](const Packet& bytes) {
    const auto packet = fsw::packets::parse_packet(bytes);
    return packet.ok() && packet.value().header.apid == Apid::kSourceAnswer;
  };
  if (packets.empty() || !is_answer(packets.back()))
    throw std::runtime_error("its answer does not end with a source_answer");
  const auto message = fsw::packets::decode<vbar::source_answer>(fsw::packets::parse_packet(packets.back()).value());
  packets.pop_back();
  if (!message.ok()) throw std::runtime_error("its source_answer is that of another version of vbar.lcm");
  if (std::ranges::any_of(packets, is_answer)) throw std::runtime_error("its answer holds a second source_answer");
  Answer answer;
  answer.packets = std::move(packets);
  answer.is_failed = message.value().status != vbar::source_answer::kReady;
  answer.available = fsw::GpsTime{message.value().available_ns};
  if (message.value().next_epoch_ns != 0) answer.next_epoch = fsw::GpsTime{message.value().next_epoch_ns};
  return answer;
}

StatedTruth truth_of(std::span<const Packet> packets, fsw::GpsTime time, const SpacecraftNumbers& numbers) {
  TruthReader reader(time, numbers);
  for (const Packet& bytes : packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok())
      throw std::runtime_error(fmt::format("{} bytes that are no packet, or have another checksum", bytes.size()));
    reader.take(packet.value());
  }
  return reader.finish();
}

std::string fault_of(std::span<const std::uint8_t> bytes, std::span<const Apid> allowed, std::uint8_t spacecraft,
                     std::uint8_t unit) {
  const auto parsed = fsw::packets::parse_packet(bytes);
  if (!parsed.ok()) return fmt::format("{} bytes that are no packet, or have another checksum", bytes.size());
  const PacketHeader& header = parsed.value().header;
  const auto apid = static_cast<unsigned>(header.apid);
  if (std::ranges::find(allowed, header.apid) == allowed.end())
    return fmt::format("a packet of APID {:#05x}, which this sensor does not have", apid);
  if (header.spacecraft != spacecraft || header.unit != unit)
    return fmt::format("a packet of spacecraft {} and unit {} in place of {} and {}", header.spacecraft, header.unit,
                       spacecraft, unit);
  if (!holds_its_message(parsed.value()))
    return fmt::format(
        "a packet of APID {:#05x} whose message has another size or type, or a number that is not finite", apid);
  return {};
}

}  // namespace vbar::external
