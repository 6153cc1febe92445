// Satellite states out of real broadcast ephemerides, against RTKLIB and against their own differences; and elements
// that no satellite has.

#include "fsw/gnss/ephemeris.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
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
}  // namespace vbar::fsw::gnss
