#include "tests/integration/experiment3/emulated_pair.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include "fsw/orbit/rtn.h"
#include "host_sim/app/initial_attitudes.h"
#include "host_sim/app/initial_orbits.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/navigation_telecommands.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/packet_encoder.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

using fsw::GpsTime;
using fsw::sources::CarrierFilter;
using fsw::sources::kPhaseChannels;
using fsw::sources::PhaseChannel;

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
      measurements_(std::make_unique<fsw::gnc::TrunkNavigation>()),
      navigation_(std::make_unique<fsw::gnc::NavigationSolution>()) {
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
  const auto is_then = [&](const twins::TruthSnapshot& truth) { return truth.time == trunk().epoch(); };
  const auto found = std::find_if(coast_.epochs().begin(), coast_.epochs().end(), is_then);
  if (found == coast_.epochs().end()) throw std::logic_error("the filter stands at an epoch that never was");
  return *found;
}

fsw::Vector6 EmulatedPair::error() const {
  const twins::TruthSnapshot& then = truth_of_filter();
  const auto truth = fsw::orbit::relative_state_rtn(then.find("servicer")->orbit, then.find("target")->orbit);
  const auto estimate = fsw::orbit::relative_state_rtn(trunk().servicer(), trunk().target().value());
  fsw::Vector6 error;
  error << estimate.position_rtn - truth.position_rtn, estimate.velocity_rtn - truth.velocity_rtn;
  return error;
}

double EmulatedPair::nees() const {
  const fsw::Vector6 e = error();
  return e.dot(fsw::filter::covariance_rtn(trunk().estimate(), trunk().servicer()).inverse() * e);
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
    const double held = (trunk().estimate().mean(CarrierFilter::ambiguity_index(k)) -
                         trunk().estimate().mean(CarrierFilter::ambiguity_index(place->second))) /
                        fsw::gnss::wavelength(channel.signal);
    const double truth = true_cycles(channel) - true_cycles(channels[place->second]);
    wrong += std::abs(held - truth) > 0.1 ? 1 : 0;
  }
  return wrong;
}

void EmulatedPair::hold(std::size_t place, std::size_t reference, double cycles) {
  // The navigation is this object's own and not const: reaching into it is what the mistakes consist of.
  auto& filter = const_cast<CarrierFilter&>(carrier().filter());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  auto& estimator =
      const_cast<fsw::filter::RelativeNavigationFilter&>(trunk());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  filter.hold(estimator, place, reference, cycles);
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
  if (count < fsw::sources::AmbiguityResolution::kMinHeld) return std::nullopt;
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
    for (int r = 0; r < kSize; ++r) covariance(r, c) = trunk().estimate().covariance(r, c);
  }
  const Eigen::VectorXd floats = difference * trunk().estimate().mean();
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

}  // namespace vbar::test
