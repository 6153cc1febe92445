#include "hil_drivers/external/truth_checks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "fsw/orbit/constants.h"
#include "host_sim/truth/extrapolation.h"

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

}  // namespace vbar::external
