#include "fsw/gnss/ephemeris.h"

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/tracking_status.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

constexpr Duration kMaxAge = duration_of_seconds(14'400);
constexpr int kMaxKeplerIterations = 10;

struct SystemConstants {
  double gm;            ///< m^3/s^2
  double earth_rate;    ///< rad/s
  double relativistic;  ///< s/m^(1/2)
};

constexpr SystemConstants constants_of(Constellation constellation) {
  switch (constellation) {
    case Constellation::kGps:
      return {kGmGps, kEarthRateGps, kRelativisticGps};
    case Constellation::kGalileo:
      return {kGmGalileo, kEarthRateGalileo, kRelativisticGalileo};
    case Constellation::kBeidou:
      return {kGmBeidou, kEarthRateBeidou, kRelativisticBeidou};
  }
  return {kGmGps, kEarthRateGps, kRelativisticGps};
}

/// BDS-SIS-ICD-B1I-3.0, table 4-1: C01 to C05 and C59 on.
constexpr bool is_geostationary(SatelliteId satellite) {
  return satellite.constellation == Constellation::kBeidou && (satellite.prn <= 5 || satellite.prn >= 59);
}

struct EccentricAnomaly {
  double sin = 0.0;
  double cos = 1.0;
  bool converged = false;
};

/// Kepler's equation by Newton's method: e is at most 0.2, where it converges quadratically from the mean anomaly.
EccentricAnomaly solve_kepler(double mean_anomaly, double e) {
  constexpr double kTolerance = 1e-14;
  double anomaly = mean_anomaly;
  for (int k = 0; k < kMaxKeplerIterations; ++k) {
    const EccentricAnomaly now{math::sin(anomaly), math::cos(anomaly), true};
    const double step = (anomaly - e * now.sin - mean_anomaly) / (1.0 - e * now.cos);
    if (math::abs(step) < kTolerance) return now;
    anomaly -= step;
  }
  return {};
}

/// The satellite in its orbital plane, x towards the node, and the plane's inclination; each with its rate.
struct PlanePoint {
  double x = 0.0, y = 0.0, x_rate = 0.0, y_rate = 0.0;
  double inclination = 0.0, inclination_rate = 0.0;
};

PlanePoint plane_point(const Ephemeris& orbit, const EccentricAnomaly& anomaly, double mean_motion, double age) {
  const double a = orbit.sqrt_a * orbit.sqrt_a;
  const double one_minus_e_cos = 1.0 - orbit.e * anomaly.cos;
  const double root = math::sqrt(1.0 - orbit.e * orbit.e);
  const double anomaly_rate = mean_motion / one_minus_e_cos;
  const double true_anomaly = math::atan2(root * anomaly.sin, anomaly.cos - orbit.e);
  const double latitude_rate = anomaly_rate * root / one_minus_e_cos;
  const double latitude = true_anomaly + orbit.omega;  // argument of latitude, uncorrected
  const double s2 = math::sin(2.0 * latitude);
  const double c2 = math::cos(2.0 * latitude);
  const auto correction = [s2, c2](double cosine, double sine) { return sine * s2 + cosine * c2; };
  const auto correction_rate = [s2, c2, latitude_rate](double cosine, double sine) {
    return 2.0 * latitude_rate * (sine * c2 - cosine * s2);
  };

  const double u = latitude + correction(orbit.cuc, orbit.cus);
  const double u_rate = latitude_rate + correction_rate(orbit.cuc, orbit.cus);
  const double radius = a * one_minus_e_cos + correction(orbit.crc, orbit.crs);
  const double radius_rate = a * orbit.e * anomaly.sin * anomaly_rate + correction_rate(orbit.crc, orbit.crs);
  const double sin_u = math::sin(u);
  const double cos_u = math::cos(u);
  return {.x = radius * cos_u,
          .y = radius * sin_u,
          .x_rate = radius_rate * cos_u - radius * sin_u * u_rate,
          .y_rate = radius_rate * sin_u + radius * cos_u * u_rate,
          .inclination = orbit.i0 + orbit.i_dot * age + correction(orbit.cic, orbit.cis),
          .inclination_rate = orbit.i_dot + correction_rate(orbit.cic, orbit.cis)};
}

/// Out of the orbital plane, with the node at `node` and its rate `node_rate`.
void rotate_out_of_plane(const PlanePoint& point, double node, double node_rate, SatelliteState& state) {
  const double sin_i = math::sin(point.inclination);
  const double cos_i = math::cos(point.inclination);
  const double sin_node = math::sin(node);
  const double cos_node = math::cos(node);
  const double across = point.y * cos_i;
  const double across_rate = point.y_rate * cos_i - point.y * sin_i * point.inclination_rate;
  state.position_ecef = {point.x * cos_node - across * sin_node, point.x * sin_node + across * cos_node,
                         point.y * sin_i};
  state.velocity_ecef = {point.x_rate * cos_node - across_rate * sin_node - node_rate * state.position_ecef.y(),
                         point.x_rate * sin_node + across_rate * cos_node + node_rate * state.position_ecef.x(),
                         point.y_rate * sin_i + point.y * cos_i * point.inclination_rate};
}

/// Geostationary satellites of BeiDou are broadcast in a frame that does not rotate with the Earth, tilted by five
/// degrees, so that their inclination is not near zero (BDS-SIS-ICD-B1I-3.0, table 5-11).
void rotate_geostationary(double age, double earth_rate, SatelliteState& state) {
  constexpr double kTilt = -5.0 * math::kDegree;
  const double sin_tilt = math::sin(kTilt);
  const double cos_tilt = math::cos(kTilt);
  const double sin_angle = math::sin(earth_rate * age);
  const double cos_angle = math::cos(earth_rate * age);
  const auto rotated = [=](const Vector3& v) {
    const double y = v.y() * cos_tilt + v.z() * sin_tilt;
    return Vector3(v.x() * cos_angle + y * sin_angle, -v.x() * sin_angle + y * cos_angle,
                   -v.y() * sin_tilt + v.z() * cos_tilt);
  };
  const Vector3 position = rotated(state.position_ecef);
  const Vector3 velocity = rotated(state.velocity_ecef);
  state.position_ecef = position;
  state.velocity_ecef = velocity + earth_rate * Vector3(position.y(), -position.x(), 0.0);
}

bool finite(const SatelliteState& state) {
  return math::is_finite(state.position_ecef.squaredNorm()) && math::is_finite(state.velocity_ecef.squaredNorm()) &&
         math::is_finite(state.clock_s) && math::is_finite(state.clock_drift);
}

}  // namespace

Result<SatelliteState> satellite_state(const Ephemeris& ephemeris, GpsTime time) {
  if (check(ephemeris) != Status::kOk) return Status::kOutOfRange;
  const Duration since_toe = time - ephemeris.toe;
  if (since_toe > kMaxAge || since_toe < Duration{-kMaxAge.ns}) return Status::kOutOfRange;
  const double age = seconds(since_toe);
  const SystemConstants system = constants_of(ephemeris.satellite.constellation);

  const double a = ephemeris.sqrt_a * ephemeris.sqrt_a;
  const double mean_motion = math::sqrt(system.gm / a) / a + ephemeris.delta_n;
  const EccentricAnomaly anomaly = solve_kepler(ephemeris.m0 + mean_motion * age, ephemeris.e);
  if (!anomaly.converged) return Status::kDidNotConverge;

  const PlanePoint point = plane_point(ephemeris, anomaly, mean_motion, age);
  const bool geostationary = is_geostationary(ephemeris.satellite);
  const double node_rate = ephemeris.omega_dot - (geostationary ? 0.0 : system.earth_rate);
  const double node = ephemeris.omega0 + node_rate * age - system.earth_rate * ephemeris.toe_of_week_s;
  SatelliteState state;
  rotate_out_of_plane(point, node, node_rate, state);
  if (geostationary) rotate_geostationary(age, system.earth_rate, state);

  const double clock_age = seconds(time - ephemeris.toc);
  const double relativity = system.relativistic * ephemeris.e * ephemeris.sqrt_a;
  const double anomaly_rate = mean_motion / (1.0 - ephemeris.e * anomaly.cos);
  state.clock_s = ephemeris.af0 + (ephemeris.af1 + ephemeris.af2 * clock_age) * clock_age + relativity * anomaly.sin;
  state.clock_drift = ephemeris.af1 + 2.0 * ephemeris.af2 * clock_age + relativity * anomaly.cos * anomaly_rate;
  if (!finite(state)) return Status::kNotFinite;
  return state;
}

}  // namespace vbar::fsw::gnss
