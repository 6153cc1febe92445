#include "tests/integration/experiment3/emulated_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fsw/gnc/telecommand_checks.h"
#include "fsw/orbit/rtn.h"
#include "fsw/packets/messages.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/simulation/initial_state.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/packet_encoder.h"
#include "tests/support/paths.h"

namespace vbar::test {

namespace {

using fsw::GpsTime;
using fsw::measurements::CarrierFilter;
using fsw::measurements::kPhaseChannels;
using fsw::measurements::PhaseChannel;

const std::string kRoot = vbar::tests::source_path();
constexpr std::uint8_t kServicerNumber = 1;

mission::Mission experiment3(std::vector<std::string> overrides, const std::vector<std::string>& more) {
  overrides.insert(overrides.end(), more.begin(), more.end());
  return sensors::load_mission(kRoot + "/missions/experiment3.toml", overrides);
}

}  // namespace

CoastingPair::CoastingPair(int duration_s, const std::vector<std::string>& overrides)
    : overrides_(overrides),
      mission_(experiment3(overrides, {})),
      truth_(app::truth_settings(mission_, kRoot + "/data")) {
  app::place_spacecraft(mission_, kRoot + "/data", truth_);
  app::set_attitudes(mission_, kRoot + "/data", truth_);
  truth::EarthRotation earth_rotation(truth_.data().earth_orientation, mission_.epoch);
  const fsw::Duration period = fsw::nearest_duration(
      mission::find_settings<sensors::GnssSensor>(*mission_.find_spacecraft("servicer"))->receiver.output.period_s);
  const GpsTime end = mission_.start_time() + fsw::duration_of_seconds(duration_s);
  for (GpsTime time = mission_.start_time(); time <= end; time = time + period) {
    truth_.advance_to(time);
    twins::TruthSnapshot& snapshot = epochs_.emplace_back();
    snapshot.time = time;
    snapshot.R_itrf_gcrf = earth_rotation.R_itrf_gcrf_at(fsw::seconds(time - mission_.epoch));
    for (const mission::Spacecraft& spacecraft : mission_.spacecraft) {
      const std::size_t index = truth_.index_of(spacecraft.name);
      snapshot.spacecraft.push_back({spacecraft.name, truth_.state(index), truth_.attitude(index)});
    }
  }
}

EmulatedPair::EmulatedPair(const CoastingPair& coast, std::uint64_t seed, const std::vector<std::string>& overrides)
    : coast_(coast),
      mission_(experiment3(coast.overrides(), overrides)),
      inbox_(kServicerNumber),
      measurements_(std::make_unique<fsw::navigation::MeasurementScheduler>()),
      navigation_(std::make_unique<fsw::navigation::NavigationSolution>()) {
  mission_.seed = seed;
  const mission::Spacecraft& servicer = *mission_.find_spacecraft("servicer");
  sensors_ = sensors::make_sources(mission_, servicer, kRoot + "/data").sources;
  twins::PacketEncoder encoder(kServicerNumber, 0);
  const auto send = [&](const auto& message) {
    under_way_.push_back({mission_.start_time(), encoder.encode(mission_.start_time(), message).value()});
  };
  send(sensors::navigation_configuration_of(mission_, servicer));
  send(sensors::earth_configuration_of(mission_, coast.earth_orientation()));
  send(mission_.navigation.thruster);
  send(sensors::receiver_configuration_of(servicer));
  send(sensors::carrier_configuration_of(mission_, servicer));
}

void EmulatedPair::fly(int epochs) {
  for (int k = 0; k < epochs && !done(); ++k, ++next_) {
    const twins::TruthSnapshot& truth = coast_.epochs()[next_];
    measure(truth);
    const auto arrived = [&](const Arrival& arrival) { return arrival.time <= truth.time; };
    const auto first_later = std::stable_partition(under_way_.begin(), under_way_.end(), arrived);
    std::vector<twins::Packet> packets;
    for (auto arrival = under_way_.begin(); arrival != first_later; ++arrival) packets.push_back(arrival->packet);
    under_way_.erase(under_way_.begin(), first_later);
    if (tamper_) tamper_(static_cast<int>(next_), packets);
    for (const twins::Packet& packet : packets) static_cast<void>(inbox_.receive(packet));
    telecommands_.update(truth.time, inbox_, fsw::gnc::telecommand_rules());
    navigation_->update(truth.time, telecommands_, inbox_, *measurements_);
    inbox_.clear(GpsTime{});
  }
}

void EmulatedPair::measure(const twins::TruthSnapshot& truth) {
  for (const auto& sensor : sensors_) {
    twins::Measurement measurement = sensor.packets->measure(truth);
    if (measurement.status != twins::MeasurementStatus::kReady) throw std::runtime_error(measurement.reason);
    for (twins::Packet& packet : measurement.packets) {
      under_way_.push_back({measurement.available, std::move(packet)});
    }
  }
  remember_integers(truth.time);
}

void EmulatedPair::remember_integers(GpsTime time) {
  Integers& integers = integers_[time];
  for (const int sign : {-1, 1}) {
    const auto& sensor = dynamic_cast<const twins::GnssSensor&>(*sensors_[sign < 0 ? 0 : 1].packets);
    const auto& receiver = dynamic_cast<const twins::gnss::GnssReceiver&>(sensor.receiver());
    for (const auto& one : receiver.truth().observations) {
      integers[{static_cast<int>(one.signal), one.satellite.prn}] += sign * one.ambiguity_cycles;
    }
  }
}

double EmulatedPair::elapsed_s() const {
  return fsw::seconds(coast_.epochs()[next_ - 1].time - coast_.epochs().front().time);
}

const twins::TruthSnapshot& EmulatedPair::truth_of_filter() const {
  const auto is_then = [&](const twins::TruthSnapshot& truth) { return truth.time == filter().epoch(); };
  const auto found = std::find_if(coast_.epochs().begin(), coast_.epochs().end(), is_then);
  if (found == coast_.epochs().end()) throw std::logic_error("the filter stands at an epoch that never was");
  return *found;
}

fsw::Vector6 EmulatedPair::error() const {
  const twins::TruthSnapshot& then = truth_of_filter();
  const auto truth = fsw::orbit::relative_state_rtn(then.find("servicer")->orbit, then.find("target")->orbit);
  const auto estimate = fsw::orbit::relative_state_rtn(filter().servicer(), filter().target().value());
  fsw::Vector6 error;
  error << estimate.position_rtn - truth.position_rtn, estimate.velocity_rtn - truth.velocity_rtn;
  return error;
}

double EmulatedPair::nees() const {
  const fsw::Vector6 e = error();
  return e.dot(fsw::filter::covariance_rtn(filter().estimate(), filter().servicer()).inverse() * e);
}

int EmulatedPair::wrong_integers() const {
  if (!carrier().last_pair()) return 0;
  const Integers& integers = integers_.at(carrier().last_pair().value());
  const auto& channels = carrier().filter().channels();
  const auto true_cycles = [&](const PhaseChannel& channel) {
    return static_cast<double>(integers.at({static_cast<int>(channel.signal), channel.satellite.prn}));
  };
  // Integers are held against each other within a signal: all must agree with the first one held.
  std::map<int, std::size_t> first;
  int wrong = 0;
  for (std::size_t k = 0; k < kPhaseChannels; ++k) {
    const PhaseChannel& channel = channels[k];
    const bool is_seen_now = channel.in_use && channel.last_seen == carrier().last_pair();
    if (!channel.fixed || !is_seen_now) continue;
    const auto [place, is_first] = first.try_emplace(static_cast<int>(channel.signal), k);
    if (is_first) continue;
    const double held = (filter().estimate().mean(CarrierFilter::ambiguity_index(k)) -
                         filter().estimate().mean(CarrierFilter::ambiguity_index(place->second))) /
                        fsw::gnss::wavelength(channel.signal);
    const double truth = true_cycles(channel) - true_cycles(channels[place->second]);
    wrong += std::abs(held - truth) > 0.1 ? 1 : 0;
  }
  return wrong;
}

void EmulatedPair::hold(std::size_t place, std::size_t reference, double cycles) {
  // The navigation is this object's own and not const: reaching into it is what the mistakes consist of.
  auto& phases = const_cast<CarrierFilter&>(carrier().filter());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  auto& estimator =
      const_cast<fsw::filter::RelativeNavigationFilter&>(filter());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  phases.hold(estimator, place, reference, cycles);
}

std::optional<EmulatedPair::Offer> EmulatedPair::offer() const {
  const auto& channels = carrier().filter().channels();
  Offer offer;
  std::map<int, std::size_t> reference;
  for (std::size_t k = 0; k < kPhaseChannels && offer.pairs.size() < fsw::gnss::kMaxAmbiguities; ++k) {
    const PhaseChannel& channel = channels[k];
    if (!channel.in_use || channel.epochs == 0) continue;
    const auto [place, is_first] = reference.try_emplace(static_cast<int>(channel.signal), k);
    if (!is_first) offer.pairs.emplace_back(k, place->second);
  }
  const auto count = static_cast<Eigen::Index>(offer.pairs.size());
  if (count < fsw::measurements::AmbiguityResolution::kMinHeld) return std::nullopt;
  constexpr Eigen::Index kSize = fsw::filter::State::kSize;
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(count, kSize);
  for (Eigen::Index row = 0; row < count; ++row) {
    const auto& [place, base] = offer.pairs[static_cast<std::size_t>(row)];
    const double wavelength = fsw::gnss::wavelength(channels[place].signal);
    difference(row, CarrierFilter::ambiguity_index(place)) = 1.0 / wavelength;
    difference(row, CarrierFilter::ambiguity_index(base)) = -1.0 / wavelength;
  }
  Eigen::MatrixXd covariance(kSize, kSize);
  for (int c = 0; c < kSize; ++c) {
    for (int r = 0; r < kSize; ++r) covariance(r, c) = filter().estimate().covariance(r, c);
  }
  const Eigen::VectorXd floats = difference * filter().estimate().mean();
  const Eigen::MatrixXd spread = difference * covariance * difference.transpose();
  const std::size_t n = offer.pairs.size();
  const auto solution = fsw::gnss::resolve_ambiguities({floats.data(), n}, {spread.data(), n * n});
  if (!solution.ok()) return std::nullopt;
  offer.integers = solution.value();
  return offer;
}

bool EmulatedPair::hold_second_best() {
  const std::optional<Offer> offered = offer();
  if (!offered) return false;
  for (std::size_t k = 0; k < offered->pairs.size(); ++k) {
    hold(offered->pairs[k].first, offered->pairs[k].second, offered->integers.second[k]);
  }
  return true;
}

bool EmulatedPair::hold_shifted(double cycles) {
  const std::optional<Offer> offered = offer();
  if (!offered) return false;
  for (std::size_t k = 0; k < offered->pairs.size(); ++k) {
    const auto& [place, base] = offered->pairs[k];
    const bool is_shifted = carrier().filter().channels()[place].satellite.prn % 2 == 1;
    hold(place, base, offered->integers.best[k] + (is_shifted ? cycles : 0.0));
  }
  return true;
}

namespace {

constexpr int kFixed = telemetry_navigation::kSourceGnssFixed;

double distance(const report::Triple& a, const report::Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

void judge(Flight& flight) {
  const report::RunRecord& record = flight.flown.record;
  ASSERT_EQ(record.estimates.size(), record.truth.size());
  double count = 0.0;
  for (std::size_t k = 0; k < record.estimates.size(); ++k) {
    const report::EstimateRow& estimate = record.estimates[k];
    if (estimate.navigation_source == kFixed && !flight.first_fix_s)
      flight.first_fix_s = estimate.time_s - record.truth.front().time_s;
    if (!flight.first_fix_s) continue;
    ASSERT_EQ(estimate.navigation_valid, 1) << estimate.time_s;
    const double position_m = distance(estimate.relative_position_rtn, record.truth[k].relative_position_rtn);
    flight.mean_position_m += position_m;
    flight.largest_position_m.add(position_m);
    flight.mean_velocity_mps += distance(estimate.relative_velocity_rtn, record.truth[k].relative_velocity_rtn);
    count += 1.0;
  }
  ASSERT_GT(count, 0.0) << "never fixed";
  flight.mean_position_m /= count;
  flight.mean_velocity_mps /= count;
}

}  // namespace

Flight fly_experiment3(std::uint64_t seed, std::vector<std::string> overrides, const Wrap& wrap) {
  overrides.push_back(fmt::format("mission.seed={}", seed));
  Flight flight;
  flight.flown = fly("experiment3.toml", overrides, wrap);
  EXPECT_TRUE(flight.flown.complete) << seed;
  judge(flight);
  return flight;
}

template <class Message>
std::vector<Message> telemetry_of(const FlownMission& flown) {
  std::vector<Message> messages;
  std::span<const std::uint8_t> rest = flown.telemetry;
  while (!rest.empty()) {
    const std::size_t size = 7U + 256U * rest[4] + rest[5];  // CCSDS 133.0-B: six bytes, and data length less one
    const auto packet = fsw::packets::parse_packet(rest.first(size));
    if (const auto message = fsw::packets::decode<Message>(packet.value()); message.ok()) {
      messages.push_back(message.value());
    }
    rest = rest.subspan(size);
  }
  return messages;
}

template std::vector<telemetry_health> telemetry_of(const FlownMission& flown);
template std::vector<telemetry_gnss> telemetry_of(const FlownMission& flown);
template std::vector<telemetry_navigation> telemetry_of(const FlownMission& flown);

namespace {

namespace packets = fsw::packets;

constexpr std::size_t kCheckSumBytes = 4;

// The manufacturer's CRC-32, bit by bit (OM-20000129, "32-bit CRC").
std::uint32_t check_sum(const Bytes& bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0U ? (crc >> 1U) ^ 0xEDB88320U : crc >> 1U;
  }
  return crc;
}

/// Takes the bytes of one kind of packets out of `all`; their header goes to `header`.
template <class Message>
Bytes take_out(std::vector<pil::Packet>& all, packets::Apid apid, packets::PacketHeader& header) {
  Bytes bytes;
  std::vector<pil::Packet> others;
  for (pil::Packet& packet : all) {
    const packets::PacketView view = packets::parse_packet(packet).value();
    if (view.header.apid != apid) {
      others.push_back(std::move(packet));
      continue;
    }
    header = view.header;
    const Message message = packets::decode<Message>(view).value();
    bytes.insert(bytes.end(), message.data, message.data + message.count);
  }
  all = std::move(others);
  return bytes;
}

/// Puts `bytes` back, before the tick. Another unit number keeps sequence counts apart from those of other steps.
template <class Message>
void put_back(std::vector<pil::Packet>& all, packets::PacketHeader header, const Bytes& bytes) {
  header.unit = 1;
  header.sequence_count = 0;
  for (std::size_t begin = 0; begin < bytes.size(); begin += sizeof(Message::data)) {
    Message message{};
    message.count = static_cast<std::int32_t>(std::min(sizeof message.data, bytes.size() - begin));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), message.count, message.data);
    pil::Packet packet(packets::kMaxPacketBytes);
    packet.resize(packets::encode(header, message, packet).value());
    all.insert(all.end() - 1, std::move(packet));
    ++header.sequence_count;
  }
}

class SpoilingComputer final : public pil::FlightComputer {
 public:
  SpoilingComputer(std::unique_ptr<pil::FlightComputer> inner, std::uint32_t first, std::uint32_t last,
                   std::function<void(ReceiverBytes&)> spoil)
      : inner_(std::move(inner)), first_(first), last_(last), spoil_(std::move(spoil)) {}

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> given) override {
    if (step < first_ || step > last_) return inner_->step(step, given);
    std::vector<pil::Packet> all(given.begin(), given.end());
    packets::PacketHeader ours, theirs;
    ReceiverBytes bytes{take_out<gnss_bytes>(all, packets::Apid::kGnssBytes, ours),
                        take_out<crosslink_gnss_bytes>(all, packets::Apid::kCrosslinkGnssBytes, theirs)};
    spoil_(bytes);
    put_back<gnss_bytes>(all, ours, bytes.servicer);
    put_back<crosslink_gnss_bytes>(all, theirs, bytes.target);
    return inner_->step(step, all);
  }
  [[nodiscard]] pil::LinkStatistics statistics() const override { return inner_->statistics(); }
  [[nodiscard]] std::string description() const override { return inner_->description(); }
  void close() override { inner_->close(); }

 private:
  std::unique_ptr<pil::FlightComputer> inner_;
  std::uint32_t first_;
  std::uint32_t last_;
  std::function<void(ReceiverBytes&)> spoil_;
};

}  // namespace

Wrap spoil_steps(std::uint32_t first, std::uint32_t last, const std::function<void(ReceiverBytes&)>& spoil) {
  return [=](std::unique_ptr<pil::FlightComputer> inner) {
    return std::make_unique<SpoilingComputer>(std::move(inner), first, last, spoil);
  };
}

void edit_messages(Bytes& bytes, const std::function<void(int id, Bytes& message)>& edit) {
  Bytes edited;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::uint8_t* header = bytes.data() + begin;
    if (bytes.size() - begin < kOemHeaderBytes || header[0] != 0xAA || header[1] != 0x44 || header[2] != 0x12)
      throw std::logic_error("the bytes to be edited are not whole messages");
    const int id = header[4] + 256 * header[5];
    const std::size_t length = kOemHeaderBytes + header[8] + 256U * header[9];
    Bytes message(header, header + length);
    edit(id, message);
    const std::size_t body = message.size() - kOemHeaderBytes;
    message[8] = static_cast<std::uint8_t>(body & 0xFFU);
    message[9] = static_cast<std::uint8_t>(body >> 8U);
    const std::uint32_t crc = check_sum(message);
    for (unsigned shift = 0; shift < 32U; shift += 8U) message.push_back(static_cast<std::uint8_t>(crc >> shift));
    edited.insert(edited.end(), message.begin(), message.end());
    begin += length + kCheckSumBytes;
  }
  bytes = std::move(edited);
}

}  // namespace vbar::test
