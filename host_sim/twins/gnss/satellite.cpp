#include "host_sim/twins/gnss/satellite.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::twins::gnss {

std::string name_of(SatelliteId satellite) {
  constexpr std::array<char, kSystems> kLetters{'G', 'E', 'C'};
  return fmt::format("{}{:02d}", kLetters[static_cast<std::size_t>(satellite.system)], satellite.prn);
}

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kGeostationaryTilt = -5.0 * std::numbers::pi / 180.0;  // BDS-SIS-ICD-B1I-3.0, table 5-11

// Time derivative of a quantity beside it.
struct Rated {
  double value;
  double rate;
};

double relativistic_constant(System system) {
  switch (system) {
    case System::kGps:
      return fsw::gnss::kRelativisticGps;
    case System::kGalileo:
      return fsw::gnss::kRelativisticGalileo;
    case System::kBeidou:
      return fsw::gnss::kRelativisticBeidou;
  }
  return 0.0;
}

// Newton's method from M: e < 0.03 converges to the last bit in four steps; the bound covers any e < 0.9.
double eccentric_anomaly(double mean_anomaly, double e) {
  double anomaly = mean_anomaly;
  for (int step = 0; step < 30; ++step) {
    const double correction = (anomaly - e * std::sin(anomaly) - mean_anomaly) / (1.0 - e * std::cos(anomaly));
    anomaly -= correction;
    if (std::abs(correction) < 1e-14) break;
  }
  return anomaly;
}

// Rotation of coordinates into a frame rotated by `angle` about z.
Matrix3 turn_about_z(double angle) {
  return Eigen::AngleAxisd(-angle, Vector3::UnitZ()).toRotationMatrix();
}
Matrix3 turn_about_x(double angle) {
  return Eigen::AngleAxisd(-angle, Vector3::UnitX()).toRotationMatrix();
}

// Harmonic correction c*cos(2u) + s*sin(2u).
Rated harmonic(double c, double s, const Rated& latitude) {
  const double cos2u = std::cos(2.0 * latitude.value);
  const double sin2u = std::sin(2.0 * latitude.value);
  return {c * cos2u + s * sin2u, 2.0 * latitude.rate * (s * cos2u - c * sin2u)};
}

// The orbit plane of a geostationary set after its frame has rotated for `elapsed_s`: the same plane and perigee,
// seen in the frame that is tilted at the later reference time.
void turn_geostationary_plane(Ephemeris& set, double elapsed_s) {
  const Matrix3 tilt = turn_about_x(kGeostationaryTilt);
  const Matrix3 R_later_earlier = tilt.transpose() * turn_about_z(earth_rate(set.satellite.system) * elapsed_s) * tilt;
  const Matrix3 R_earlier_orbit =
      (turn_about_z(set.omega) * turn_about_x(set.i0) * turn_about_z(set.node_at_toe)).transpose();
  const Matrix3 R = R_later_earlier * R_earlier_orbit;  // columns: perigee, along track at perigee, normal
  set.i0 = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
  set.node_at_toe = std::atan2(R(0, 2), -R(1, 2));
  set.omega = std::atan2(R(2, 0), R(2, 1));
}

}  // namespace

double gravitational_parameter(System system) {
  switch (system) {
    case System::kGps:
      return fsw::gnss::kGmGps;
    case System::kGalileo:
      return fsw::gnss::kGmGalileo;
    case System::kBeidou:
      return fsw::gnss::kGmBeidou;
  }
  return 0.0;
}

double earth_rate(System system) {
  switch (system) {
    case System::kGps:
      return fsw::gnss::kEarthRateGps;
    case System::kGalileo:
      return fsw::gnss::kEarthRateGalileo;
    case System::kBeidou:
      return fsw::gnss::kEarthRateBeidou;
  }
  return 0.0;
}

double mean_motion(const Ephemeris& ephemeris) {
  const double a = ephemeris.sqrt_a * ephemeris.sqrt_a;
  return std::sqrt(gravitational_parameter(ephemeris.satellite.system) / (a * a * a)) + ephemeris.delta_n;
}

SatelliteState satellite_state(const Ephemeris& ephemeris, fsw::GpsTime time, double offset_s) {
  const System system = ephemeris.satellite.system;
  const double tk = seconds(time - ephemeris.toe) + offset_s;
  const double a = ephemeris.sqrt_a * ephemeris.sqrt_a;
  const double e = ephemeris.e;
  const double n = mean_motion(ephemeris);
  const double anomaly = eccentric_anomaly(ephemeris.m0 + n * tk, e);
  const double sin_e = std::sin(anomaly);
  const double cos_e = std::cos(anomaly);
  const double anomaly_rate = n / (1.0 - e * cos_e);
  const double root = std::sqrt(1.0 - e * e);

  const Rated argument{std::atan2(root * sin_e, cos_e - e) + ephemeris.omega, anomaly_rate * root / (1.0 - e * cos_e)};
  const Rated du = harmonic(ephemeris.cuc, ephemeris.cus, argument);
  const Rated dr = harmonic(ephemeris.crc, ephemeris.crs, argument);
  const Rated di = harmonic(ephemeris.cic, ephemeris.cis, argument);
  const Rated u{argument.value + du.value, argument.rate + du.rate};
  const Rated r{a * (1.0 - e * cos_e) + dr.value, a * e * sin_e * anomaly_rate + dr.rate};
  const Rated i{ephemeris.i0 + ephemeris.i_dot * tk + di.value, ephemeris.i_dot + di.rate};

  const double rate = earth_rate(system);
  const double node_rate = is_geostationary(ephemeris.satellite) ? ephemeris.omega_dot : ephemeris.omega_dot - rate;
  const double node = ephemeris.node_at_toe + node_rate * tk;

  // In the orbit plane, x to the node; then rotated by inclination and node.
  const double x = r.value * std::cos(u.value);
  const double y = r.value * std::sin(u.value);
  const double vx = r.rate * std::cos(u.value) - y * u.rate;
  const double vy = r.rate * std::sin(u.value) + x * u.rate;
  const double cos_i = std::cos(i.value);
  const double sin_i = std::sin(i.value);
  const double cos_node = std::cos(node);
  const double sin_node = std::sin(node);
  const double y_level = y * cos_i;
  const double vy_level = vy * cos_i - y * sin_i * i.rate;

  SatelliteState state;
  state.position_ecef << x * cos_node - y_level * sin_node, x * sin_node + y_level * cos_node, y * sin_i;
  state.velocity_ecef << vx * cos_node - vy_level * sin_node - node_rate * state.position_ecef.y(),
      vx * sin_node + vy_level * cos_node + node_rate * state.position_ecef.x(), vy * sin_i + y * cos_i * i.rate;

  if (is_geostationary(ephemeris.satellite)) {
    const Matrix3 R = turn_about_z(rate * tk) * turn_about_x(kGeostationaryTilt);
    state.position_ecef = (R * state.position_ecef).eval();
    state.velocity_ecef = R * state.velocity_ecef - rate * Vector3::UnitZ().cross(state.position_ecef);
  }

  const double relativity = relativistic_constant(system) * e * ephemeris.sqrt_a;
  state.clock_s = ephemeris.af0 + (ephemeris.af1 + ephemeris.af2 * tk) * tk + relativity * sin_e;
  state.clock_drift = ephemeris.af1 + 2.0 * ephemeris.af2 * tk + relativity * cos_e * anomaly_rate;
  return state;
}

Ephemeris with_reference_time(const Ephemeris& ephemeris, fsw::GpsTime toe) {
  const double elapsed_s = seconds(toe - ephemeris.toe);
  Ephemeris moved = ephemeris;
  moved.toe = toe;
  moved.m0 = std::remainder(ephemeris.m0 + mean_motion(ephemeris) * elapsed_s, 2.0 * std::numbers::pi);
  moved.i0 += ephemeris.i_dot * elapsed_s;
  moved.af0 += (ephemeris.af1 + ephemeris.af2 * elapsed_s) * elapsed_s;
  moved.af1 += 2.0 * ephemeris.af2 * elapsed_s;
  if (is_geostationary(ephemeris.satellite)) {
    turn_geostationary_plane(moved, elapsed_s);
  } else {
    const double node_rate = ephemeris.omega_dot - earth_rate(ephemeris.satellite.system);
    moved.node_at_toe = std::remainder(ephemeris.node_at_toe + node_rate * elapsed_s, 2.0 * std::numbers::pi);
  }
  return moved;
}

}  // namespace vbar::twins::gnss
