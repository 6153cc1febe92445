// Valid elements of a navigation satellite. The bounds are the ranges of the fields in the interface documents
// (the widest of IS-GPS-200N tables 20-I to 20-III, Galileo OS SIS ICD 2.1 tables 61, 65, 67, BDS-SIS-ICD-B1I-3.0
// tables 5-6, 5-9), except where navigation satellites occupy a narrower range.

#include <array>
#include <span>

#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/tracking_status.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
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

}  // namespace vbar::fsw::gnss
