#include "fsw/gnss/ephemeris.h"

#include <array>
#include <optional>
#include <span>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_range.h"
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

// Valid elements of a navigation satellite. The bounds are the ranges of the fields in the interface documents
// (the widest of IS-GPS-200N tables 20-I to 20-III, Galileo OS SIS ICD 2.1 tables 61, 65, 67, BDS-SIS-ICD-B1I-3.0
// tables 5-6, 5-9), except where navigation satellites occupy a narrower range.

namespace {

// Medium orbits of GPS (5153), BeiDou (5282), Galileo (5440), inclined and geostationary ones of BeiDou (6493).
constexpr double kMinSqrtA = 4900.0;
constexpr double kMaxSqrtA = 6700.0;
// IS-GPS-200N, table 20-III; Galileo has two satellites at 0.16 (E14, E18).
constexpr double kMaxEccentricityGps = 0.03;
constexpr double kMaxEccentricity = 0.2;
// Sent between -pi and pi; receivers that convert them to radians may make them positive.
constexpr double kMaxAngle = math::kTwoPi;
constexpr double kMaxDeltaN = 1.2e-8;          // 15 bits of 2^-43 semicircles/s
constexpr double kMaxNodeRate = 3.0e-6;        // 23 bits of the same
constexpr double kMaxIDot = 3.0e-9;            // 13 bits of the same
constexpr double kMaxAngleHarmonic = 6.2e-5;   // 17 bits of 2^-31 rad (BeiDou)
constexpr double kMaxRadiusHarmonic = 2048.0;  // 17 bits of 2^-6 m (BeiDou)
constexpr double kMaxClock = 0.0625;           // 30 bits of 2^-34 s (Galileo)
constexpr double kMaxClockRate = 1.5e-8;       // 20 bits of 2^-46 (Galileo)
constexpr double kMaxClockAging = 3.6e-15;     // 7 bits of 2^-55 /s (GPS)
constexpr double kMaxGroupDelay = 1.2e-7;      // 9 bits of 2^-32 s (Galileo)
// Clock and orbit of a set refer to the same hour or two.
constexpr Duration kMaxClockApart = duration_of_seconds(86'400);

struct Bounded {
  double value;
  double bound;
};

Status all_within(std::span<const Bounded> list) {
  Status status = Status::kOk;
  for (const Bounded& entry : list) {
    if (!math::is_finite(entry.value)) return Status::kNotFinite;
    if (math::abs(entry.value) > entry.bound) status = Status::kOutOfRange;
  }
  return status;
}

Duration magnitude(Duration d) {
  return d.ns < 0 ? Duration{-d.ns} : d;
}

bool times_agree(const Ephemeris& ephemeris) {
  const GpsTime end = start_of_week(kMaxWeek + 1);
  const auto sensible = [end](GpsTime time) { return time.ns > 0 && time < end; };
  if (!sensible(ephemeris.toe) || !sensible(ephemeris.toc)) return false;
  if (magnitude(ephemeris.toe - ephemeris.toc) > kMaxClockApart) return false;
  const bool beidou = ephemeris.satellite.constellation == Constellation::kBeidou;
  const Duration of_week = time_of_week(beidou ? ephemeris.toe - kGpsMinusBeidouTime : ephemeris.toe);
  return ephemeris.toe_of_week_s >= 0.0 && ephemeris.toe_of_week_s < static_cast<double>(kSecondsPerWeek) &&
         nearest_duration(ephemeris.toe_of_week_s) == of_week;
}

}  // namespace

Status check(const Ephemeris& ephemeris) {
  const SatelliteId& satellite = ephemeris.satellite;
  const bool gps = satellite.constellation == Constellation::kGps;
  const std::array<Bounded, 20> list{
      {{ephemeris.sqrt_a, kMaxSqrtA},       {ephemeris.e, gps ? kMaxEccentricityGps : kMaxEccentricity},
       {ephemeris.m0, kMaxAngle},           {ephemeris.omega0, kMaxAngle},
       {ephemeris.i0, kMaxAngle},           {ephemeris.omega, kMaxAngle},
       {ephemeris.delta_n, kMaxDeltaN},     {ephemeris.omega_dot, kMaxNodeRate},
       {ephemeris.i_dot, kMaxIDot},         {ephemeris.cuc, kMaxAngleHarmonic},
       {ephemeris.cus, kMaxAngleHarmonic},  {ephemeris.cic, kMaxAngleHarmonic},
       {ephemeris.cis, kMaxAngleHarmonic},  {ephemeris.crc, kMaxRadiusHarmonic},
       {ephemeris.crs, kMaxRadiusHarmonic}, {ephemeris.toe_of_week_s, static_cast<double>(kSecondsPerWeek)},
       {ephemeris.af0, kMaxClock},          {ephemeris.af1, kMaxClockRate},
       {ephemeris.af2, kMaxClockAging},     {ephemeris.group_delay_s, kMaxGroupDelay}}};
  const Status status = all_within(list);
  if (status != Status::kOk) return status;
  const bool known = satellite.prn > 0 && satellite.prn <= highest_prn(satellite.constellation);
  if (!known || ephemeris.sqrt_a < kMinSqrtA || ephemeris.e < 0.0 || !times_agree(ephemeris)) {
    return Status::kOutOfRange;
  }
  return Status::kOk;
}

namespace {

/// Index in the table; no value for a number outside the constellation.
std::optional<std::size_t> place_of(gnss::SatelliteId satellite) {
  constexpr std::array<std::size_t, gnss::kConstellations> kFirst{0, 32, 68};
  constexpr std::array<std::size_t, gnss::kConstellations> kCount{32, 36, 63};
  const auto system = static_cast<std::size_t>(satellite.constellation);
  if (system >= gnss::kConstellations || satellite.prn < 1 || satellite.prn > kCount[system]) return std::nullopt;
  return kFirst[system] + satellite.prn - 1U;
}

Duration distance(GpsTime a, GpsTime b) {
  return a < b ? b - a : a - b;
}

}  // namespace

Status EphemerisStore::put(const gnss::Ephemeris& ephemeris) {
  const std::optional<std::size_t> place = place_of(ephemeris.satellite);
  if (!place) return Status::kOutOfRange;
  if (const Status status = gnss::check(ephemeris); status != Status::kOk) return status;
  Sets& sets = satellites_[*place];
  for (std::size_t k = 0; k < sets.count; ++k) {
    if (sets.set[k].issue == ephemeris.issue && sets.set[k].toe == ephemeris.toe) {
      sets.set[k] = ephemeris;
      return Status::kOk;
    }
  }
  if (sets.count < sets.set.size()) {
    sets.set[sets.count++] = ephemeris;
  } else {
    sets.set[sets.set[0].toe < sets.set[1].toe ? 0 : 1] = ephemeris;  // the older one is replaced
  }
  return Status::kOk;
}

const gnss::Ephemeris* EphemerisStore::find(gnss::SatelliteId satellite, GpsTime time) const {
  const std::optional<std::size_t> place = place_of(satellite);
  if (!place) return nullptr;
  const gnss::Ephemeris* nearest = nullptr;
  for (std::size_t k = 0; k < satellites_[*place].count; ++k) {
    const gnss::Ephemeris& candidate = satellites_[*place].set[k];
    const Duration age = distance(candidate.toe, time);
    if (!candidate.healthy || age > kLongestAge) continue;
    if (nearest == nullptr || age < distance(nearest->toe, time)) nearest = &candidate;
  }
  return nearest;
}

}  // namespace vbar::fsw::gnss
