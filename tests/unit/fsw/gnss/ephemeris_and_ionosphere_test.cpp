// Satellite states out of real broadcast ephemerides, against RTKLIB and against their own differences; and elements
// that no satellite has.

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/ionosphere.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/gnss/broadcast_records.h"

namespace vbar::fsw::gnss {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(SatelliteState, IsRtklibs) {
  const std::vector<Ephemeris> records = test::broadcast_records();
  accuracy::Largest position;
  accuracy::Largest velocity;
  accuracy::Largest clock;
  accuracy::Largest drift;
  std::set<Constellation> systems;
  const std::vector<test::ReferenceState> states = test::broadcast_states();
  for (const test::ReferenceState& reference : states) {
    const Ephemeris& record = records.at(reference.record);
    const Result<SatelliteState> state = satellite_state(record, reference.time);
    ASSERT_TRUE(state.ok());
    const auto& v = reference.values;
    systems.insert(record.satellite.constellation);
    position.add((state.value().position_ecef - Vector3(v[0], v[1], v[2])).norm());
    velocity.add((state.value().velocity_ecef - Vector3(v[3], v[4], v[5])).norm());
    clock.add(std::abs(state.value().clock_s - v[6]));
    drift.add(std::abs(state.value().clock_drift - v[7]));
  }
  EXPECT_EQ(states.size(), 105U);
  EXPECT_EQ(systems.size(), kConstellations);
  const char* const reference = "RTKLIB eph2pos, 105 states of 15 satellites of GPS, Galileo, BeiDou (all orbit kinds)";
  // The table's six decimals (1e-6 m); angles of up to 45 rad round to 7e-15 rad, 3e-7 m at 42,000 km.
  accuracy::expect_below("broadcast satellite position", reference, position, 2e-6, "m");
  // The same 3e-7 m in the reference's differences over four seconds.
  accuracy::expect_below("broadcast satellite velocity", reference, velocity, 1e-7, "m/s");
  // Relativistic constants differ in the tenth digit (RTKLIB works with sqrt(mu) itself), of up to 4e-8 s.
  accuracy::expect_below("broadcast satellite clock", reference, clock, 1e-16, "s");
  // The table has seven digits of up to 1e-10.
  accuracy::expect_below("broadcast satellite clock drift", reference, drift, 6e-18, "s/s");
}

TEST(SatelliteState, VelocityIsTheDerivativeOfThePosition) {
  for (const Ephemeris& record : test::broadcast_records()) {
    for (const std::int64_t minutes : {-239, -100, 0, 77, 239}) {
      const GpsTime time = record.toe + duration_of_seconds(60 * minutes);
      const auto at = [&record, time](std::int64_t ms) {
        return satellite_state(record, time + Duration{ms * 1'000'000}).value();
      };
      const Vector3 difference = (8.0 * (at(4000).position_ecef - at(-4000).position_ecef) -
                                  (at(8000).position_ecef - at(-8000).position_ecef)) /
                                 48.0;
      // Angles of up to 45 rad round to 7e-15 rad, 3e-7 m at 42,000 km; over four seconds.
      EXPECT_LT((difference - at(0).velocity_ecef).norm(), 1e-7);
    }
  }
}

TEST(SatelliteState, IsGivenForFourHours) {
  for (const Ephemeris& record : test::broadcast_records()) {
    for (const std::int64_t sign : {-1, 1}) {
      const Duration four_hours = duration_of_seconds(sign * 14'400);
      EXPECT_TRUE(satellite_state(record, record.toe + four_hours).ok());
      EXPECT_EQ(satellite_state(record, record.toe + four_hours + Duration{sign}).status(), Status::kOutOfRange);
    }
  }
  const Ephemeris record = test::broadcast_records().front();
  for (const std::int64_t far : {std::numeric_limits<std::int64_t>::max(), std::int64_t{0}}) {
    EXPECT_EQ(satellite_state(record, GpsTime{far}).status(), Status::kOutOfRange);
  }
}

TEST(SatelliteState, GoesOnOverTheEndOfTheWeek) {
  // The elements of one satellite as broadcast before the week's end and two hours later, in the new week: the same
  // orbit to what two sets agree on. Here the later set is the earlier one, propagated: its toe alone moves on.
  Ephemeris before = test::broadcast_records().front();
  before.toe = start_of_week(1659) - duration_of_seconds(3600);
  before.toc = before.toe;
  before.toe_of_week_s = 604'800.0 - 3600.0;
  before.delta_n = before.i_dot = before.cuc = before.cus = before.cic = before.cis = before.crc = before.crs = 0.0;
  before.af0 = before.af1 = before.af2 = 0.0;
  Ephemeris after = before;
  constexpr double kStep_s = 7200.0;
  after.toe = before.toe + duration_of_seconds(7200);
  after.toc = after.toe;
  after.toe_of_week_s = 3600.0;
  const double a = before.sqrt_a * before.sqrt_a;
  after.m0 = std::remainder(before.m0 + std::sqrt(3.986005e14 / (a * a * a)) * kStep_s, 2.0 * M_PI);
  // The node is given at the beginning of the week, in the frame of then.
  after.omega0 = before.omega0 + before.omega_dot * kStep_s - 7.2921151467e-5 * 604'800.0;
  after.omega0 = std::remainder(after.omega0, 2.0 * M_PI);
  for (const std::int64_t minutes : {-90, -1, 0, 1, 90}) {
    const GpsTime time = start_of_week(1659) + duration_of_seconds(60 * minutes);
    const SatelliteState a_state = satellite_state(before, time).value();
    const SatelliteState b_state = satellite_state(after, time).value();
    // Angles of 50 rad in double precision (7e-15 rad) at 26,600 km, a few times.
    EXPECT_LT((a_state.position_ecef - b_state.position_ecef).norm(), 2e-6);
  }
}

TEST(EphemerisCheck, TakesRealOnes) {
  for (const Ephemeris& record : test::broadcast_records()) EXPECT_EQ(check(record), Status::kOk);
}

TEST(EphemerisCheck, RefusesWhatIsNotANumber) {
  const Ephemeris good = test::broadcast_records().front();
  for (double Ephemeris::*field : test::kEphemerisNumbers) {
    Ephemeris bad = good;
    for (const double value : {kNaN, std::numeric_limits<double>::infinity()}) {
      bad.*field = value;
      EXPECT_EQ(check(bad), Status::kNotFinite);
      EXPECT_EQ(satellite_state(bad, bad.toe).status(), Status::kOutOfRange);
    }
    bad.*field = 1e9;
    EXPECT_EQ(check(bad), Status::kOutOfRange);
  }
}

TEST(EphemerisCheck, RefusesAbsurdElements) {
  const Ephemeris good = test::broadcast_records().front();
  const auto status_with = [&good](auto change) {
    Ephemeris bad = good;
    change(bad);
    return check(bad);
  };
  EXPECT_EQ(status_with([](Ephemeris& e) { e.e = 0.031; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.e = -1e-9; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.sqrt_a = 2650.0; }), Status::kOutOfRange);  // a low orbit
  EXPECT_EQ(status_with([](Ephemeris& e) { e.sqrt_a = 0.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.sqrt_a = -5153.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.satellite.prn = 0; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.satellite.prn = 33; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toe.ns += 1'000'000'000; }), Status::kOutOfRange);  // not toe_of_week_s
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toe_of_week_s += 604'800.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toe_of_week_s = -16.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toc.ns = 1; }), Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toc.ns = std::numeric_limits<std::int64_t>::min(); }),
            Status::kOutOfRange);
  EXPECT_EQ(status_with([](Ephemeris& e) { e.toe.ns = std::numeric_limits<std::int64_t>::max(); }),
            Status::kOutOfRange);
  // Galileo has two satellites on orbits with an eccentricity of 0.16.
  Ephemeris galileo = test::broadcast_records()[5];
  ASSERT_EQ(galileo.satellite.constellation, Constellation::kGalileo);
  galileo.e = 0.16;
  EXPECT_EQ(check(galileo), Status::kOk);
  EXPECT_TRUE(satellite_state(galileo, galileo.toe).ok());
}

}  // namespace

// Klobuchar's model against the worked example and the document's own limiting cases.

namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr KlobucharCoefficients kExample{.alpha = {3.82e-8, 1.49e-8, -1.79e-7, 0.0},
                                         .beta = {1.43e5, 0.0, -3.28e5, 1.13e5}};
constexpr LineOfSight kSight{
    .latitude = 40.0 * kDegree, .longitude = 260.0 * kDegree, .azimuth = 210.0 * kDegree, .elevation = 20.0 * kDegree};

GpsTime time_of_week(std::int64_t s) {
  return {(1000 * 604'800 + s) * kNanosecondsPerSecond};
}

TEST(Klobuchar, GivesTheWorkedExample) {
  // Classic example of the literature (Strang and Borre, Linear Algebra, Geodesy, and GPS): 23.784 m.
  const Result<double> delay = klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100));
  ASSERT_TRUE(delay.ok());
  accuracy::expect_below("Klobuchar delay", "worked example, 23.784 m", std::abs(delay.value() - 23.784), 5e-4, "m");
}

TEST(Klobuchar, AtNightItIsFiveNanosecondsTimesTheSlant) {
  // IS-GPS-200N: 5e-9 s and, towards the zenith, a factor of 1 + 16 (0.53 - 0.5)^3.
  LineOfSight zenith = kSight;
  zenith.elevation = M_PI / 2.0;
  const Result<double> delay = klobuchar_delay_l1_m(kExample, zenith, time_of_week(8 * 3600));  // 01:20 local time
  EXPECT_NEAR(delay.value(), 299'792'458.0 * 5e-9 * (1.0 + 16.0 * 0.03 * 0.03 * 0.03), 1e-12);
}

TEST(Klobuchar, RepeatsEveryDayAndEveryTurn) {
  const double delay = klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100)).value();
  // Local time to rounding: 1e-9 s of some 1e5, of a slope of metres an hour.
  EXPECT_NEAR(klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100 - 86'400)).value(), delay, 1e-9);
  LineOfSight turned = kSight;
  turned.longitude -= 2.0 * M_PI;
  EXPECT_NEAR(klobuchar_delay_l1_m(kExample, turned, time_of_week(593'100)).value(), delay, 1e-9);
}

TEST(Klobuchar, RefusesWhatItHasNoMeaningFor) {
  const auto with_elevation = [](double elevation) {
    LineOfSight sight = kSight;
    sight.elevation = elevation;
    return klobuchar_delay_l1_m(kExample, sight, time_of_week(0)).status();
  };
  EXPECT_EQ(with_elevation(0.0), Status::kOk);
  EXPECT_EQ(with_elevation(-1e-9), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(-19.8 * kDegree), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(1.58), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(kNaN), Status::kOutOfRange);
  LineOfSight nowhere = kSight;
  nowhere.longitude = kNaN;
  EXPECT_EQ(klobuchar_delay_l1_m(kExample, nowhere, time_of_week(0)).status(), Status::kNotFinite);
  for (std::size_t k = 0; k < 4; ++k) {
    KlobucharCoefficients bad = kExample;
    bad.alpha[k] = kNaN;
    EXPECT_EQ(check(bad), Status::kNotFinite);
    bad = kExample;
    bad.beta[k] = 1e9;
    EXPECT_EQ(klobuchar_delay_l1_m(bad, kSight, time_of_week(0)).status(), Status::kOutOfRange);
  }
}

// The shell halves the electrons above the spacecraft: by quadrature of the Chapman profile exp(1 - z - e^-z), z the
// height over the peak at 420 km in units of 100 km. The slant factor at the horizon is that of the sine rule.
TEST(ShellCrossing, HalvesTheElectronsAboveTheSpacecraft) {
  constexpr double kEarth_m = 6371e3;
  for (const double altitude_m : {500e3, 709e3, 900e3}) {
    const Vector3 position = (kEarth_m + altitude_m) * Vector3(0.6, 0.0, 0.8), zenith(0.6, 0.0, 0.8),
                  level(0.8, 0.0, -0.6);
    const double shell_m = altitude_m + shell_crossing(position, zenith).distance_m;
    const auto electrons = [](double from_m, double to_m) {
      constexpr int kSteps = 20000;
      double sum = 0.0;
      for (int k = 0; k < kSteps; ++k) {
        const double z = (from_m + (k + 0.5) * (to_m - from_m) / kSteps - 420e3) / 100e3;
        sum += std::exp(1.0 - z - std::exp(-z));
      }
      return sum * (to_m - from_m) / kSteps;
    };
    // 2000 km above the spacecraft the rest is e^-20 of them; the midpoint rule is exact to 1e-6.
    EXPECT_NEAR(electrons(altitude_m, shell_m) / electrons(altitude_m, altitude_m + 2000e3), 0.5, 1e-5) << altitude_m;
    EXPECT_NEAR(shell_crossing(position, zenith).slant_factor, 1.0, 1e-12);
    const double sine = (kEarth_m + altitude_m) / (kEarth_m + shell_m);
    EXPECT_NEAR(shell_crossing(position, level).slant_factor, 1.0 / std::sqrt(1.0 - sine * sine), 1e-6);
    EXPECT_NEAR(shell_crossing(position, level).distance_m, (kEarth_m + shell_m) * std::sqrt(1.0 - sine * sine), 1e-3);
  }
}

TEST(ShellCrossing, IsVerticalAtTheGround) {
  const ShellCrossing crossing = shell_crossing(Vector3(6371e3, 0.0, 0.0), Vector3::UnitY());
  EXPECT_EQ(crossing.slant_factor, 1.0);
  EXPECT_EQ(crossing.distance_m, 0.0);
}

}  // namespace

}  // namespace vbar::fsw::gnss
