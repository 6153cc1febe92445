#include "emulators/grand/radio_field/sky.h"

#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "emulators/grand/radio_field/rf_block.h"
#include "fsw/gnss/constants.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::grand::bench {

namespace {

/// Value and two derivatives of a polynomial of degree five.
struct Values {
  double value, first, second;
};

Values values_of(const double (&c)[truth::kNodePoints], double x) {
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))),
          c[1] + x * (2.0 * c[2] + x * (3.0 * c[3] + x * (4.0 * c[4] + x * 5.0 * c[5]))),
          2.0 * c[2] + x * (6.0 * c[3] + x * (12.0 * c[4] + x * 20.0 * c[5]))};
}

}  // namespace

SatelliteOrbits::SatelliteOrbits(std::shared_ptr<const twins::gnss::Constellation> constellation, fsw::GpsTime start)
    : constellation_(std::move(constellation)), start_(start), satellites_(constellation_->size()) {}

SatelliteMotion SatelliteOrbits::at(std::size_t index, double time_s) {
  const double intervals = time_s / kInterval_s;
  const double interval = std::floor(intervals);
  const Piece& p = piece(index, static_cast<std::int64_t>(interval));
  const double x = intervals - interval;
  constexpr double kPerSecond = 1.0 / kInterval_s;
  SatelliteMotion motion;
  for (int axis = 0; axis < 3; ++axis) {
    const Values v = values_of(p.coefficients[axis], x);
    motion.position[axis] = v.value;
    motion.velocity[axis] = v.first * kPerSecond;
    motion.acceleration[axis] = v.second * (kPerSecond * kPerSecond);
  }
  const Values clock = values_of(p.coefficients[3], x);
  motion.clock_m = clock.value;
  motion.clock_rate_mps = clock.first * kPerSecond;
  return motion;
}

const SatelliteOrbits::Piece& SatelliteOrbits::piece(std::size_t index, std::int64_t interval) {
  Piece& p = satellites_[index].pieces[static_cast<std::size_t>(interval & 1)];
  if (p.interval == interval) return p;
  double values[kQuantities][truth::kNodePoints];
  for (int k = 0; k < truth::kNodePoints; ++k) {
    const Node& n = node(index, interval + truth::kFirstNode + k);
    for (std::size_t q = 0; q < kQuantities; ++q) values[q][k] = n[q];
  }
  for (std::size_t q = 0; q < kQuantities; ++q) truth::fit_node_polynomial(values[q], p.coefficients[q]);
  p.interval = interval;
  return p;
}

const SatelliteOrbits::Node& SatelliteOrbits::node(std::size_t index, std::int64_t number) {
  Satellite& satellite = satellites_[index];
  const auto slot = static_cast<std::size_t>(number & 7);
  if (satellite.node_numbers[slot] != number) {
    const twins::gnss::SatelliteState state =
        constellation_->true_state(index, start_, static_cast<double>(number) * kInterval_s);
    satellite.nodes[slot] = {state.position_ecef.x(), state.position_ecef.y(), state.position_ecef.z(),
                             fsw::gnss::kSpeedOfLight * state.clock_s};
    satellite.node_numbers[slot] = number;
  }
  return satellite.nodes[slot];
}

namespace {

std::string stream_name(std::string_view vehicle, twins::gnss::SatelliteId satellite, twins::gnss::Signal signal,
                        std::string_view quantity) {
  std::string name = "grand/box/";
  name.append(vehicle).append("/").append(name_of(satellite)).append("/");
  return name.append(structure(signal).name).append("/").append(quantity);
}

}  // namespace

ChannelErrors::ChannelErrors(const BoxErrorSettings& settings, std::uint64_t seed, std::string_view vehicle,
                             twins::gnss::SatelliteId satellite, twins::gnss::Signal signal)
    : sigma_m_(settings.channel_phase_mm * 1e-3),
      blocks_per_time_constant_(settings.channel_phase_time_s / seconds(RfBlock::kLength)),
      decay_(std::exp(-1.0 / blocks_per_time_constant_)),
      stream_(seed, stream_name(vehicle, satellite, signal, "channel_phase")) {
  engine::RandomStream alignment(seed, stream_name(vehicle, satellite, signal, "alignment"));
  carrier_alignment_m_ = alignment.normal() * settings.carrier_alignment_mm * 1e-3;
  code_alignment_m_ = alignment.normal() * settings.code_alignment_mm * 1e-3;
}

ChannelErrors::Wander ChannelErrors::wander(std::int64_t number) {
  if (sigma_m_ == 0.0) return {};
  step_to(number);
  const double begin_m = phase_m_;
  step_to(number + 1);
  return {begin_m, phase_m_};
}

void ChannelErrors::step_to(std::int64_t node) {
  if (!started_) {
    started_ = true;
    node_ = node;
    phase_m_ = sigma_m_ * stream_.normal();
    return;
  }
  const std::int64_t steps = node - node_;
  if (steps <= 0) return;
  const double decay = steps == 1 ? decay_ : std::exp(-static_cast<double>(steps) / blocks_per_time_constant_);
  phase_m_ = decay * phase_m_ + sigma_m_ * std::sqrt(1.0 - decay * decay) * stream_.normal();
  node_ = node;
}

namespace {

using fsw::Duration;
using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;
using twins::gnss::Signal;

constexpr double kBlock_s = 0.1;
constexpr std::int64_t kBlocksPerSecond = 10;
constexpr double kFirstTravel_s = 0.075;
// From any first travel time each pass leaves 1.3e-5 of the error; from a predicted one (1e-14 s) one pass is exact.
constexpr int kFirstPasses = 3;
constexpr double kEarthRate = fsw::gnss::kEarthRateGps;

/// Earth rate cross v, without the zero terms.
Vector3 earth_rate_cross(const Vector3& v) {
  return {-kEarthRate * v.y(), kEarthRate * v.x(), 0.0};
}

/// Components of an Earth-fixed vector of the instant of transmission in the frame of reception, `angle` (below 1e-4)
/// later: series exact to the last bit.
Vector3 rotated(const Vector3& v, double angle) {
  const double c = 1.0 - 0.5 * angle * angle;
  const double s = angle * (1.0 - angle * angle / 6.0);
  return {c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z()};
}

/// The quintic with these values and two derivatives at 0 and kBlock_s.
RangePolynomial hermite(double p0, double v0, double a0, double p1, double v1, double a1) {
  constexpr double h = kBlock_s;
  const double d = p1 - p0 - h * (v0 + 0.5 * h * a0);
  const double e = h * (v1 - v0 - h * a0);
  const double f = h * h * (a1 - a0);
  return {{p0, v0, 0.5 * a0, (10.0 * d - 4.0 * e + 0.5 * f) / (h * h * h), (-15.0 * d + 7.0 * e - f) / (h * h * h * h),
           (6.0 * d - 3.0 * e + 0.5 * f) / (h * h * h * h * h)}};
}

/// Adds `change` over the block with a first and second derivative of zero at its ends.
void add_smooth_step(RangePolynomial& polynomial, double begin, double change) {
  constexpr double h = kBlock_s;
  polynomial.coefficients[0] += begin;
  polynomial.coefficients[3] += 10.0 * change / (h * h * h);
  polynomial.coefficients[4] -= 15.0 * change / (h * h * h * h);
  polynomial.coefficients[5] += 6.0 * change / (h * h * h * h * h);
}

/// The cubic through the second and third of four values one second apart with the slopes of their neighbours, in the
/// time since `offset_s` after the second value.
std::array<double, 4> cubic(const std::array<double, 4>& y, double offset_s) {
  const double a1 = 0.5 * (y[2] - y[0]);
  const double a2 = y[0] - 2.5 * y[1] + 2.0 * y[2] - 0.5 * y[3];
  const double a3 = 0.5 * (y[3] - y[0]) + 1.5 * (y[1] - y[2]);
  const double u = offset_s;
  return {y[1] + u * (a1 + u * (a2 + u * a3)), a1 + u * (2.0 * a2 + u * 3.0 * a3), a2 + 3.0 * u * a3, a3};
}

}  // namespace

Sky::Sky(const SkySettings& settings, std::shared_ptr<SatelliteOrbits> orbits, twins::gnss::AntennaPattern pattern,
         std::uint64_t seed, std::string_view vehicle)
    : settings_(settings), orbits_(std::move(orbits)), pattern_(std::move(pattern)), satellites_(orbits_->size()) {
  for (std::size_t index = 0; index < satellites_.size(); ++index) {
    const twins::gnss::SatelliteId id = orbits_->constellation().id(index);
    for (std::size_t k = 0; k < twins::gnss::kSignals; ++k) {
      const auto signal = static_cast<Signal>(k);
      if (twins::gnss::structure(signal).system != id.system) continue;
      const double delay_s = twins::gnss::code_delay_s(signal, orbits_->constellation().group_delay_s(index));
      satellites_[index].channels.push_back({signal, twins::gnss::ionosphere_scale(signal), kSpeedOfLight * delay_s,
                                             ChannelErrors(settings.box, seed, vehicle, id, signal)});
    }
  }
}

void Sky::fill(VehicleMotion& motion, std::int64_t number, bool is_radiated, RfBlock& block) {
  block.begin = orbits_->start() + Duration{number * RfBlock::kLength.ns};
  block.snapped = motion.take_snap();
  block.signals.clear();
  if (!is_radiated) return;

  const Duration begin{number * RfBlock::kLength.ns};
  if (block.snapped) {  // nothing of the old motion holds
    second_ = state_number_ = kNever;
    for (Satellite& satellite : satellites_) satellite.slow_second = satellite.node_number = kNever;
  }
  const MotionState first = state_number_ == number ? state_ : motion.at(begin);
  state_ = motion.at(begin + RfBlock::kLength);
  state_number_ = number + 1;

  const std::int64_t second = number / kBlocksPerSecond;
  if (second_ != second) begin_second(motion, second);
  for (std::size_t index = 0; index < satellites_.size(); ++index)
    if (satellites_[index].slow[1].is_visible) fill_satellite(index, number, first, state_, block);
}

void Sky::begin_second(const VehicleMotion& motion, std::int64_t second) {
  second_ = second;
  for (std::size_t k = 0; k < slow_antenna_.size(); ++k) {
    const Duration time = fsw::duration_of_seconds(second - 1 + static_cast<std::int64_t>(k));
    const MotionState state = motion.at(time);
    const fsw::GpsTime gps = orbits_->start() + time;
    slow_antenna_[k] = {seconds(time), week_time(twins::gnss::System::kGps, gps).seconds_of_week(), state.position,
                        state.velocity, motion.boresight_ecef(time)};
  }
  for (std::size_t index = 0; index < satellites_.size(); ++index) update_slow(index, second);
}

// Values computed for a second before are kept, so that the curves through them are continuous.
void Sky::update_slow(std::size_t index, std::int64_t second) {
  Satellite& satellite = satellites_[index];
  const bool goes_on = satellite.slow_second == second - 1 && satellite.slow[1].is_visible;
  satellite.slow_second = second;
  if (goes_on) {
    for (std::size_t k = 0; k < 3; ++k) satellite.slow[k] = satellite.slow[k + 1];
    satellite.slow[3] = slow_node(index, slow_antenna_[3]);
    return;
  }
  satellite.slow[1] = slow_node(index, slow_antenna_[1]);
  if (!satellite.slow[1].is_visible) return;
  for (const std::size_t k : {0, 2, 3}) satellite.slow[k] = slow_node(index, slow_antenna_[k]);
}

Sky::SlowNode Sky::slow_node(std::size_t index, const SlowAntenna& antenna) {
  // The satellite's position at transmission within 1e-3 m: one step from a typical travel time.
  const SatelliteMotion about = orbits_->at(index, antenna.time_s - kFirstTravel_s);
  const double travel_s = (about.position - antenna.position).norm() / kSpeedOfLight;
  const Vector3 position =
      rotated(about.position - (travel_s - kFirstTravel_s) * about.velocity, kEarthRate * travel_s);
  const twins::gnss::AntennaState state{orbits_->start(), antenna.time_s, antenna.position, antenna.velocity,
                                        antenna.boresight};
  SlowNode node;
  node.is_visible = twins::gnss::is_visible(position, state, settings_.visibility);
  const Vector3 difference = position - antenna.position;
  const double range_m = difference.norm();
  const Vector3 line_of_sight = difference / range_m;
  node.shapiro_m = twins::gnss::shapiro_delay_m(position.norm(), antenna.position.norm(), range_m);
  if (settings_.ionosphere)
    node.ionosphere_l1_m = twins::gnss::klobuchar_delay_in_orbit_m(
        orbits_->constellation().corrections().klobuchar, antenna.position, line_of_sight, antenna.seconds_of_week);
  const double attenuation_db = pattern_.attenuation_db(line_of_sight.dot(antenna.boresight));
  const Satellite& satellite = satellites_[index];
  for (std::size_t k = 0; k < satellite.channels.size(); ++k)
    node.cn0_dbhz[k] = twins::gnss::carrier_to_noise_dbhz(settings_.link_budget, satellite.channels[k].signal, range_m,
                                                          attenuation_db);
  return node;
}

// Derivatives of |s(t - range/c) - r(t)| in the inertial frame that coincides with the Earth-fixed one at reception.
Sky::RangeNode Sky::range_node(std::size_t index, double time_s, const MotionState& antenna, double travel_s,
                               int passes) {
  SatelliteMotion sent;
  Vector3 position = Vector3::Zero();
  Vector3 difference = Vector3::Zero();
  double range_m = 0.0;
  double angle = 0.0;
  for (int pass = 0; pass < passes; ++pass) {
    sent = orbits_->at(index, time_s - travel_s);
    angle = kEarthRate * travel_s;
    position = rotated(sent.position, angle);
    difference = position - antenna.position;
    range_m = difference.norm();
    travel_s = range_m / kSpeedOfLight;
  }
  const Vector3 los = difference / range_m;
  const Vector3 turning = rotated(sent.velocity, angle);
  const Vector3 velocity = turning + earth_rate_cross(position);
  const Vector3 acceleration =
      rotated(sent.acceleration, angle) + earth_rate_cross(2.0 * turning + earth_rate_cross(position));
  const Vector3 antenna_velocity = antenna.velocity + earth_rate_cross(antenna.position);
  const Vector3 antenna_acceleration =
      antenna.acceleration + earth_rate_cross(2.0 * antenna.velocity + earth_rate_cross(antenna.position));

  const double shrink = 1.0 / (1.0 + los.dot(velocity) / kSpeedOfLight);
  const double rate = los.dot(velocity - antenna_velocity) * shrink;
  const double at_satellite = 1.0 - rate / kSpeedOfLight;  // satellite's time per time of reception
  const double relative_squared = (at_satellite * velocity - antenna_velocity).squaredNorm();
  const double second = ((relative_squared - rate * rate) / range_m +
                         los.dot(at_satellite * at_satellite * acceleration - antenna_acceleration)) *
                        shrink;
  return {range_m - sent.clock_m, rate - sent.clock_rate_mps * at_satellite, second, travel_s, rate / kSpeedOfLight};
}

void Sky::fill_satellite(std::size_t index, std::int64_t number, const MotionState& begin, const MotionState& end,
                         RfBlock& block) {
  Satellite& satellite = satellites_[index];
  const double begin_s = static_cast<double>(number) * kBlock_s;
  const double end_s = static_cast<double>(number + 1) * kBlock_s;
  if (satellite.node_number != number) satellite.node = range_node(index, begin_s, begin, kFirstTravel_s, kFirstPasses);
  const RangeNode& from = satellite.node;
  const double predicted_s =
      from.travel_s + kBlock_s * (from.travel_rate + 0.5 * kBlock_s * from.acceleration_mps2 / kSpeedOfLight);
  const RangeNode to = range_node(index, end_s, end, predicted_s, 1);
  const RangePolynomial common =
      hermite(from.value_m, from.rate_mps, from.acceleration_mps2, to.value_m, to.rate_mps, to.acceleration_mps2);
  satellite.node = to;
  satellite.node_number = number + 1;

  const auto& slow = satellite.slow;
  const double offset_s = static_cast<double>(number % kBlocksPerSecond) * kBlock_s;
  const Cubic shapiro = cubic({slow[0].shapiro_m, slow[1].shapiro_m, slow[2].shapiro_m, slow[3].shapiro_m}, offset_s);
  const Cubic ionosphere = cubic(
      {slow[0].ionosphere_l1_m, slow[1].ionosphere_l1_m, slow[2].ionosphere_l1_m, slow[3].ionosphere_l1_m}, offset_s);
  for (std::size_t k = 0; k < satellite.channels.size(); ++k) {
    Channel& channel = satellite.channels[k];
    RfSignal& signal = block.signals.emplace_back();
    signal.satellite = orbits_->constellation().id(index);
    signal.signal = channel.signal;
    signal.cn0_dbhz = slow[1].cn0_dbhz[k];
    signal.carrier_m = signal.code_m = common;
    for (std::size_t power = 0; power < ionosphere.size(); ++power) {
      const double delay = channel.ionosphere_scale * ionosphere[power];
      signal.carrier_m.coefficients[power] += shapiro[power] - delay;
      signal.code_m.coefficients[power] += shapiro[power] + delay;
    }
    signal.code_m.coefficients[0] += channel.group_delay_m + channel.errors.code_alignment_m();
    const ChannelErrors::Wander wander = channel.errors.wander(number);
    add_smooth_step(signal.carrier_m, channel.errors.carrier_alignment_m() + wander.begin_m,
                    wander.end_m - wander.begin_m);
  }
}

}  // namespace vbar::grand::bench
