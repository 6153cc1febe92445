#include "hil_drivers/external/external_truth.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/rtn.h"
#include "hil_drivers/external/exchange.h"
#include "host_sim/truth/orbital_motion.h"

namespace vbar::external {

namespace {

using fsw::orbit::CartesianState;

constexpr double kPolarRadius = 6356752.3;  // m, WGS 84
constexpr double kPosition_m = 10.0;
constexpr double kVelocity_mps = 0.01;
constexpr double kStep_s = 10.0;
/// Tolerance of quaternions and rotation matrices in double precision, with a margin.
constexpr double kUnit = 1e-9;
constexpr double kFirstAttitude_deg = 1.0;

CartesianState along_point_mass(CartesianState state, double seconds) {
  const double steps = std::max(1.0, std::ceil(seconds / kStep_s));
  for (double step = 0.0; step < steps; ++step)
    state = truth::orbit_ahead(state, fsw::orbit::kMu, fsw::Vector3::Zero(), seconds / steps);
  return state;
}

std::string fault_of_jump(const twins::SpacecraftTruth& stated, const CartesianState& before, double seconds) {
  const CartesianState led = along_point_mass(before, seconds);
  const double rate = led.velocity_eci.norm() / led.position_eci.norm();
  const double drift_m = 1.5 * kLargestPerturbation * seconds * seconds;
  const double position_m = (stated.orbit.position_eci - led.position_eci).norm();
  const double most_m = kPosition_m + drift_m;
  constexpr const char* kAccepted = "m and m/s in GCRF";
  if (!(position_m <= most_m))
    return fmt::format(
        "a position of the spacecraft {} that is {:.6g} m from where its state of {:.6g} s before leads, more than the "
        "{:.6g} m that forces can make; accepted: {}",
        stated.name, position_m, seconds, most_m, kAccepted);
  const double velocity_mps = (stated.orbit.velocity_eci - led.velocity_eci).norm();
  const double most_mps = kVelocity_mps + 3.0 * kLargestPerturbation * seconds + rate * drift_m;
  if (!(velocity_mps <= most_mps))
    return fmt::format(
        "a velocity of the spacecraft {} that is {:.6g} m/s from where its state of {:.6g} s before leads, more than "
        "the {:.6g} m/s that forces can make; accepted: {}",
        stated.name, velocity_mps, seconds, most_mps, kAccepted);
  return {};
}

}  // namespace

std::string fault_of_motion(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& before,
                            fsw::Duration interval) {
  const fsw::Vector3& position_eci = stated.orbit.position_eci;
  if (!(position_eci.norm() >= kPolarRadius))
    return fmt::format(
        "a position of the spacecraft {} below the Earth's surface, {:.6g} m from its centre; accepted: m", stated.name,
        position_eci.norm());
  if (const std::string jump = fault_of_jump(stated, before.orbit, fsw::seconds(interval)); !jump.empty()) return jump;
  const fsw::Vector3 gravity = truth::central_acceleration(fsw::orbit::kMu, position_eci);
  const double perturbation = (stated.acceleration_eci.value_or(fsw::Vector3::Zero()) - gravity).norm();
  if (!(perturbation <= kLargestPerturbation))
    return fmt::format(
        "an acceleration of the spacecraft {} that is {:.6g} m/s^2 from that of the Earth's point mass; accepted: up "
        "to "
        "{} m/s^2, gravity included",
        stated.name, perturbation, kLargestPerturbation);
  if (stated.attitude && !(std::abs(stated.attitude->q_body_eci.norm() - 1.0) < kUnit))
    return fmt::format("a quaternion of the spacecraft {} whose norm is {:.12g}; accepted: 1", stated.name,
                       stated.attitude->q_body_eci.norm());
  return {};
}

std::string fault_of_first_attitude(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& expected) {
  if (!expected.attitude || !stated.attitude) return {};
  const double apart_deg =
      truth::angle_between(stated.attitude->q_body_eci, expected.attitude->q_body_eci) * 180.0 / std::numbers::pi;
  if (apart_deg <= kFirstAttitude_deg) return {};
  return fmt::format(
      "an attitude of the spacecraft {} that is {:.6g} deg from that at the start; accepted: q_body_eci, w first, to "
      "body from ECI",
      stated.name, apart_deg);
}

std::string fault_of_rotation(const fsw::Matrix3& R_itrf_gcrf) {
  const bool is_orthogonal = (R_itrf_gcrf * R_itrf_gcrf.transpose() - fsw::Matrix3::Identity()).norm() < kUnit;
  return is_orthogonal && R_itrf_gcrf.determinant() > 0.0 ? "" : "a true_earth that is not a rotation";
}

namespace {

void copy_to(const fsw::Vector3& values, double (&numbers)[3]) {
  std::copy(values.begin(), values.end(), numbers);
}

fsw::packets::PacketHeader header_of(std::uint8_t spacecraft, fsw::GpsTime time) {
  fsw::packets::PacketHeader header;
  header.time = time;
  header.spacecraft = spacecraft;
  return header;
}

/// Calls `call`; its exception becomes one sentence that names the truth.
template <class Call>
void naming_the_truth(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("source {}: {}", kTruth, error.what()));
  }
}

}  // namespace

ExternalTruth::ExternalTruth(testbeds::TruthPlan plan, Connect connect)
    : plan_(std::move(plan)),
      numbers_(numbers_of(plan_.mission)),
      connect_(std::move(connect)),
      earth_rotation_(plan_.earth_orientation, plan_.mission.epoch),
      is_pointed_(plan_.servicer.attitude && std::holds_alternative<mission::Commanded>(*plan_.servicer.attitude)),
      present_(plan_.start),
      expected_(plan_.start.spacecraft) {}

void ExternalTruth::start() {
  if (program_) return;
  naming_the_truth([&] {
    program_ = connect_();
    open();
    ask_for(present_.time);
    for (const twins::SpacecraftTruth& expected : plan_.start.spacecraft)
      if (const std::string fault = fault_of_first_attitude(*present_.find(expected.name), expected); !fault.empty())
        throw std::runtime_error("its answer holds " + fault);
  });
}

void ExternalTruth::end() noexcept {
  try {
    if (program_) program_->close();
  } catch (...) {
    // The run is over, and the program has ended.
  }
  program_.reset();
}

void ExternalTruth::open() {
  Batch batch;
  batch.time = present_.time;
  batch.opening = Opening{std::string(kTruth), static_cast<std::int64_t>(plan_.mission.seed), plan_.servicer.number, 0};
  batch.truth = plan_.start;
  if (!exchange(batch).packets.empty()) throw std::runtime_error("the program sent packets before it was asked");
}

void ExternalTruth::advance_to(fsw::GpsTime time) {
  if (time < present_.time) throw std::invalid_argument("the truth does not go back in time");
  if (time > present_.time) naming_the_truth([&] { ask_for(time); });
}

twins::TruthSnapshot ExternalTruth::snapshot(twins::TruthDetail detail) {
  if (!commands_.empty()) naming_the_truth([&] { ask_for(present_.time); });
  twins::TruthSnapshot truth = present_;
  if (detail == twins::TruthDetail::kAccelerations) return truth;
  for (twins::SpacecraftTruth& one : truth.spacecraft) {
    one.acceleration_eci.reset();
    one.angular_acceleration_body.reset();
  }
  return truth;
}

void ExternalTruth::apply_impulse_rtn(const fsw::Vector3& dv_rtn) {
  vbar::executed_maneuver message{};
  message.accepted = 1;
  copy_to(dv_rtn, message.dv_rtn);
  commands_.push_back({packet_of(header_of(plan_.servicer.number, present_.time), message), present_.time});
  const auto servicer = std::ranges::find(expected_, plan_.servicer.name, &twins::SpacecraftTruth::name);
  servicer->orbit = fsw::orbit::apply_impulse_rtn(servicer->orbit, dv_rtn);
}

void ExternalTruth::point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn,
                          const fsw::Vector3& boresight_rate_rtn) {
  if (!is_pointed_) return;
  vbar::pointing_command message{};
  copy_to(boresight_rtn, message.boresight_rtn);
  copy_to(boresight_rate_rtn, message.boresight_rate_rtn);
  commands_.push_back({packet_of(header_of(plan_.servicer.number, time), message), time});
}

twins::TruthSnapshot ExternalTruth::at(fsw::GpsTime time) {
  const fsw::Duration ahead = time - present_.time;
  if (ahead < fsw::Duration{} || ahead > kHorizon)
    throw std::out_of_range("the truth's outlook reaches one second ahead");
  twins::TruthSnapshot truth = snapshot(twins::TruthDetail::kAccelerations);
  if (ahead == fsw::Duration{}) return truth;
  const double seconds = fsw::seconds(ahead);
  truth.time = time;
  truth.R_itrf_gcrf = modelled_earth_at(time) * modelled_earth_at(present_.time).transpose() * present_.R_itrf_gcrf;
  for (twins::SpacecraftTruth& one : truth.spacecraft) {
    const auto gravity = [&] { return truth::central_acceleration(fsw::orbit::kMu, one.orbit.position_eci); };
    const fsw::Vector3 perturbation = *one.acceleration_eci - gravity();
    one.orbit = truth::orbit_ahead(one.orbit, fsw::orbit::kMu, perturbation, seconds);
    one.acceleration_eci = gravity() + perturbation;
    if (one.attitude)
      one.attitude =
          truth::attitude_ahead(*one.attitude, one.angular_acceleration_body.value_or(fsw::Vector3::Zero()), seconds);
  }
  return truth;
}

fsw::Matrix3 ExternalTruth::modelled_earth_at(fsw::GpsTime time) {
  return earth_rotation_.R_itrf_gcrf_at(fsw::seconds(time - plan_.mission.epoch));
}

void ExternalTruth::ask_for(fsw::GpsTime time) {
  Batch batch;
  batch.time = time;
  batch.commands = commands_;
  const Answer answer = exchange(batch);
  ++exchanges_;
  try {
    take(truth_of(answer.packets, time, numbers_));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("at {:.9g} s of the run its answer holds {}", fsw::seconds(time - plan_.start.time), error.what()));
  }
  commands_.clear();
}

Answer ExternalTruth::exchange(const Batch& batch) {
  const auto begin = std::chrono::steady_clock::now();
  const std::uint32_t step = step_++;
  Answer answer = answer_of(program_->step(step, packets_of(batch, step, numbers_)).packets);
  wall_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (answer.is_failed) throw std::runtime_error("the program reports a failure");
  return answer;
}

/// In the order of the mission.
void ExternalTruth::take(StatedTruth stated) {
  twins::TruthSnapshot next;
  next.time = stated.truth.time;
  if (stated.has_earth) {
    next.R_itrf_gcrf = stated.truth.R_itrf_gcrf;
    if (const std::string fault = fault_of_rotation(next.R_itrf_gcrf); !fault.empty()) throw std::runtime_error(fault);
  } else {
    next.R_itrf_gcrf = modelled_earth_at(next.time);
  }
  for (const twins::SpacecraftTruth& expected : expected_) {
    const twins::SpacecraftTruth* const one = stated.truth.find(expected.name);
    if (one == nullptr) throw std::runtime_error(fmt::format("no true_state of the spacecraft {}", expected.name));
    check(*one, expected, next.time - present_.time);
    next.spacecraft.push_back(*one);
  }
  present_ = std::move(next);
  expected_ = present_.spacecraft;
}

void ExternalTruth::check(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& expected,
                          fsw::Duration interval) const {
  if (!stated.attitude && plan_.start.find(stated.name)->attitude)
    throw std::runtime_error(fmt::format(
        "no attitude of the spacecraft {}, which has one in the mission; accepted: has_attitude = 1", stated.name));
  if (const std::string fault = fault_of_motion(stated, expected, interval); !fault.empty())
    throw std::runtime_error(fault);
}

}  // namespace vbar::external
