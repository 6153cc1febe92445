#include "host_sim/twins/gnss/signal_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace vbar::twins::gnss {
namespace {

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;

constexpr double kEarthRadius_m = 6378137.0;
constexpr double kFirstTravel_s = 0.075;
// Each pass shrinks the error of the travel time by v/c = 1.3e-5: after three, 1e-8 m are left of any start.
constexpr int kPasses = 3;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

// A satellite at transmission, in the frame of reception.
struct Transmission {
  Vector3 position;
  Vector3 velocity;  ///< relative to the rotating frame
  double clock_s;
  double clock_drift;
};

template <class StateAt>
Transmission transmission(const StateAt& state_at, const AntennaState& antenna, double travel_s) {
  const SatelliteState state = state_at(antenna.offset_s - travel_s);
  const double angle = fsw::gnss::kEarthRateGps * travel_s;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const auto turned = [c, s](const Vector3& v) { return Vector3(c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z()); };
  return {turned(state.position_ecef), turned(state.velocity_ecef), state.clock_s, state.clock_drift};
}

template <class StateAt>
SignalPath path_from(const StateAt& state_at, const AntennaState& antenna, double travel_s, int passes) {
  Transmission sent{};
  double range_m = 0.0;
  for (int pass = 0; pass < passes; ++pass) {
    sent = transmission(state_at, antenna, travel_s);
    range_m = (sent.position - antenna.position_ecef).norm();
    travel_s = range_m / kSpeedOfLight;
  }
  SignalPath path;
  path.line_of_sight = (sent.position - antenna.position_ecef) / range_m;
  path.range_m = range_m;
  path.shapiro_m = shapiro_delay_m(sent.position.norm(), antenna.position_ecef.norm(), range_m);
  path.satellite_clock_s = sent.clock_s;
  path.satellite_clock_drift = sent.clock_drift;
  // Range rate is the derivative of |s(t - range/c) - r(t)| in the inertial frame that coincides with the Earth-fixed
  // one at reception.
  const Vector3 rotation = fsw::gnss::kEarthRateGps * Vector3::UnitZ();
  const Vector3 satellite_velocity = sent.velocity + rotation.cross(sent.position);
  const Vector3 antenna_velocity = antenna.velocity_ecef + rotation.cross(antenna.position_ecef);
  path.range_rate_mps = path.line_of_sight.dot(satellite_velocity - antenna_velocity) /
                        (1.0 + path.line_of_sight.dot(satellite_velocity) / kSpeedOfLight);
  return path;
}

}  // namespace

bool is_visible(const Vector3& satellite_ecef, const AntennaState& antenna, const VisibilitySettings& settings) {
  const Vector3 to_satellite = (satellite_ecef - antenna.position_ecef).normalized();
  const double radius_m = antenna.position_ecef.norm();
  const double sin_elevation = to_satellite.dot(antenna.position_ecef) / radius_m;
  if (sin_elevation < std::sin(radians(settings.horizon_mask_deg))) return false;
  if (to_satellite.dot(antenna.boresight_ecef) < std::cos(radians(settings.receiver_mask_deg / 2.0))) return false;
  if (to_satellite.dot(satellite_ecef.normalized()) < std::cos(radians(settings.transmit_aperture_deg / 2.0)))
    return false;
  const double closest_m = radius_m * std::sqrt(std::max(0.0, 1.0 - sin_elevation * sin_elevation));
  return sin_elevation >= 0.0 || closest_m > kEarthRadius_m + settings.occultation_altitude_km * 1e3;
}

double shapiro_delay_m(double transmitter_radius_m, double receiver_radius_m, double range_m) {
  constexpr double kTwoGmPerC2 = 2.0 * fsw::gnss::kGmGps / (kSpeedOfLight * kSpeedOfLight);
  const double sum_m = transmitter_radius_m + receiver_radius_m;
  return kTwoGmPerC2 * std::log((sum_m + range_m) / (sum_m - range_m));
}

std::optional<SignalPath> visible_path(const Constellation& constellation, std::size_t index,
                                       const AntennaState& antenna, const VisibilitySettings& settings) {
  const auto state_at = [&](double offset_s) { return constellation.true_state(index, antenna.time, offset_s); };
  const Transmission about = transmission(state_at, antenna, kFirstTravel_s);
  if (!is_visible(about.position, antenna, settings)) return std::nullopt;
  const double travel_s = (about.position - antenna.position_ecef).norm() / kSpeedOfLight;
  return path_from(state_at, antenna, travel_s, kPasses - 1);
}

SignalPath broadcast_path(const Ephemeris& ephemeris, const AntennaState& antenna) {
  const auto state_at = [&](double offset_s) { return satellite_state(ephemeris, antenna.time, offset_s); };
  return path_from(state_at, antenna, kFirstTravel_s, kPasses);
}

}  // namespace vbar::twins::gnss
