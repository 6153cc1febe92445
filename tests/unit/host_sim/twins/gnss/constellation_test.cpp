#include "host_sim/twins/gnss/constellation.h"

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/system_time.h"
#include "host_sim/twins/gnss/tracking.h"
#include "tests/support/paths.h"

namespace vbar::twins::gnss {

namespace {

const std::filesystem::path kData = std::filesystem::path(vbar::tests::source_path("data"));
constexpr fsw::GpsTime kMission = gps_time_of(System::kGps, 1645, 2 * 86400 + 57600);  // 2011-07-19 16:00

std::size_t count(const Constellation& constellation, System system) {
  std::size_t number = 0;
  for (std::size_t k = 0; k < constellation.size(); ++k)
    if (constellation.id(k).system == system) ++number;
  return number;
}

TEST(Constellation, HoldsTheSatellitesOfItsFiles) {
  const Constellation broadcast(kData, {}, kMission, 1);
  EXPECT_EQ(count(broadcast, System::kGps), 31U);  // the paper: "a GPS constellation of 31 space vehicles"
  EXPECT_EQ(count(broadcast, System::kGalileo), 4U);
  EXPECT_EQ(count(broadcast, System::kBeidou), 14U);
  const Constellation nominal(kData, {.galileo = SatelliteSet::kNominal, .beidou = SatelliteSet::kNominal}, kMission,
                              1);
  EXPECT_EQ(count(nominal, System::kGalileo), 24U);
  EXPECT_EQ(count(nominal, System::kBeidou), 24U);
  const Constellation gps(kData, {.galileo = SatelliteSet::kNone, .beidou = SatelliteSet::kNone}, kMission, 1);
  EXPECT_EQ(gps.size(), 31U);
}

// Moved to another day, a satellite stands over the same place at the same time of day.
TEST(Constellation, KeepsTheGeometryOfTheDay) {
  const ConstellationSettings exact{
      .orbit_error_radial_m = 0.0, .orbit_error_transverse_m = 0.0, .orbit_error_normal_m = 0.0, .clock_error_ns = 0.0};
  const Constellation constellation(kData, exact, kMission, 1);
  const std::vector<Ephemeris> file = read_ephemeris_file(kData / "gps" / "gps_2011_10_20.csv").satellites;
  const std::int64_t day_ns = 86400 * fsw::kNanosecondsPerSecond;
  for (std::size_t k = 0; k < file.size(); ++k) {
    ASSERT_EQ(constellation.id(k), file[k].satellite);
    const fsw::GpsTime same_time{kMission.ns / day_ns * day_ns + file[k].toe.ns % day_ns};
    const SatelliteState moved = constellation.true_state(k, same_time, 0.0);
    EXPECT_LT((moved.position_ecef - satellite_state(file[k], file[k].toe).position_ecef).norm(), 1e-6);
  }
}

// True minus broadcast over satellites and seeds has the sizes asked for: 49 satellites, 40 seeds, one time; each
// satellite's two draws are independent, so a root mean square of 1960 x 3 values is within 5 % (4 sigma).
TEST(Constellation, ErrorsHaveTheirSizes) {
  const ConstellationSettings settings{
      .orbit_error_radial_m = 2.0, .orbit_error_transverse_m = 2.0, .orbit_error_normal_m = 2.0, .clock_error_ns = 3.0};
  double square_m2 = 0.0;
  double clock_square = 0.0;
  double number = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Constellation constellation(kData, settings, kMission, seed);
    for (std::size_t k = 0; k < constellation.size(); ++k) {
      const SatelliteState truth = constellation.true_state(k, kMission, 0.0);
      const SatelliteState told = satellite_state(constellation.broadcast_set(k, kMission).ephemeris, kMission);
      square_m2 += (truth.position_ecef - told.position_ecef).squaredNorm() / 3.0;
      clock_square += std::pow((truth.clock_s - told.clock_s) * 1e9, 2);
      number += 1.0;
    }
  }
  EXPECT_NEAR(std::sqrt(square_m2 / number), 2.0, 0.1);
  EXPECT_NEAR(std::sqrt(clock_square / number), 3.0, 0.25);  // 1960 values: 6.4 % (4 sigma), rounding of 0.3 ns
}

// The true motion has no step where a broadcast set ends; the broadcast one steps by rounding only. Half a day on, at
// a boundary of every system's sets: Wednesday 4h of the mission's week.
TEST(Constellation, SetsFollowEachOtherSmoothly) {
  const Constellation constellation(kData, {}, kMission, 3);
  for (std::size_t k = 0; k < constellation.size(); ++k) {
    const fsw::GpsTime boundary =
        gps_time_of(constellation.id(k).system, constellation.id(k).system == System::kBeidou ? 289 : 1645, 273600);
    const BroadcastSet before = constellation.broadcast_set(k, boundary - fsw::Duration{1});
    const BroadcastSet after = constellation.broadcast_set(k, boundary);
    EXPECT_NE(before.issue, after.issue);
    EXPECT_LT(before.ephemeris.toe, after.ephemeris.toe);
    const double step_m = (satellite_state(before.ephemeris, boundary).position_ecef -
                           satellite_state(after.ephemeris, boundary).position_ecef)
                              .norm();
    EXPECT_LT(step_m, 0.3) << name_of(constellation.id(k));  // two roundings, the rates' grown over two hours
    EXPECT_LE(std::abs(seconds(after.ephemeris.toe - boundary)), 7200.0);
  }
}

TEST(Constellation, IsTheSameForTheSameSeedOnly) {
  const Constellation a(kData, {}, kMission, 5);
  const Constellation b(kData, {}, kMission, 5);
  const Constellation c(kData, {}, kMission, 6);
  EXPECT_EQ(a.true_state(3, kMission, 0.1).position_ecef, b.true_state(3, kMission, 0.1).position_ecef);
  EXPECT_NE(a.true_state(3, kMission, 0.1).position_ecef, c.true_state(3, kMission, 0.1).position_ecef);
}

TEST(Constellation, RefusesWithOneClearError) {
  const auto message = [](const ConstellationSettings& settings) -> std::string {
    try {
      const Constellation constellation(kData, settings, kMission, 1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({.gps = SatelliteSet::kNominal}),
            "gps = nominal: GPS has no nominal set; accepted are none and broadcast");
  EXPECT_EQ(message({.orbit_error_radial_m = -1.0}), "orbit_error_radial_m = -1: accepted is 0 to 1e6");
  EXPECT_EQ(message({.clock_error_ns = std::nan("")}), "clock_error_ns = nan: accepted is 0 to 1e6");
  EXPECT_EQ(message({.gps = SatelliteSet::kNone, .galileo = SatelliteSet::kNone, .beidou = SatelliteSet::kNone}),
            "gps, galileo and beidou are all none: no satellite is left");
  EXPECT_THROW(Constellation("/nonexistent", {}, kMission, 1), std::runtime_error);
}

}  // namespace

namespace {

constexpr fsw::GpsTime kStart{994'986'015'000'000'000};
constexpr SatelliteId kG05{System::kGps, 5};

fsw::GpsTime at(int t) {
  return kStart + fsw::duration_of_seconds(t);
}

TrackingSettings no_slips() {
  TrackingSettings settings;
  settings.cycle_slips_per_hour = 0.0;
  return settings;
}

// When the first satellite of each seed is found, over seeds: between the two bounds of the mode.
TEST(Tracking, StartsAsItsMode) {
  for (const auto& [mode, least, most] : {std::tuple{StartMode::kCold, 20, 60}, std::tuple{StartMode::kWarm, 1, 8}}) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      StartSettings start;
      start.mode = mode;
      SatelliteTracking tracking(kG05, start, no_slips(), seed, "test");
      int found = -1;
      for (int t = 0; t <= 61 && found < 0; ++t) {
        tracking.update(at(t), t == 0, {45.0, 42.0});
        if (tracking.signals()[0].tracking) found = t;
      }
      EXPECT_GE(found, least);
      EXPECT_LE(found, most);
      EXPECT_TRUE(tracking.signals()[1].tracking);
      EXPECT_LE(tracking.signals()[0].lock_since, at(found));
      EXPECT_GT(tracking.signals()[0].lock_since, at(found - 1));
    }
  }
}

// Locked above one threshold, kept down to another; another integer after each loss.
TEST(Tracking, LosesAndReacquires) {
  SatelliteTracking tracking(kG05, {}, no_slips(), 1, "test");
  int t = 0;
  const auto run = [&](int seconds, double cn0) {
    for (const int end = t + seconds; t < end; ++t) tracking.update(at(t), t == 0, {cn0, cn0});
    return tracking.signals()[0].tracking;
  };
  EXPECT_FALSE(run(20, 32.0));  // too weak to be found
  EXPECT_TRUE(run(20, 40.0));
  const std::int64_t first = tracking.signals()[0].ambiguity_cycles;
  EXPECT_TRUE(run(20, 30.0));  // weak, but held
  EXPECT_EQ(tracking.signals()[0].ambiguity_cycles, first);
  EXPECT_FALSE(run(2, 27.0));
  EXPECT_FALSE(tracking.heard_since().has_value());
  EXPECT_TRUE(run(20, 40.0));
  EXPECT_NE(tracking.signals()[0].ambiguity_cycles, first);
  tracking.update(at(t), false, {});  // below the horizon
  EXPECT_FALSE(tracking.signals()[0].tracking);
}

// A weaker second signal comes and goes alone.
TEST(Tracking, SecondSignalFollowsTheFirst) {
  SatelliteTracking tracking(kG05, {}, no_slips(), 1, "test");
  for (int t = 0; t < 30; ++t) tracking.update(at(t), t == 0, {40.0, 25.0});
  EXPECT_TRUE(tracking.signals()[0].tracking);
  EXPECT_FALSE(tracking.signals()[1].tracking);
  tracking.update(at(30), false, {40.0, 40.0});
  EXPECT_TRUE(tracking.signals()[1].tracking);
  EXPECT_EQ(tracking.signals()[1].lock_since, at(29));  // since some instant after the last epoch without it
}

TEST(Tracking, SlipsOnCommand) {
  SatelliteTracking tracking(kG05, {}, no_slips(), 1, "test");
  for (int t = 0; t < 30; ++t) tracking.update(at(t), t == 0, {45.0, 42.0});
  const std::int64_t before = tracking.signals()[0].ambiguity_cycles;
  const fsw::GpsTime lock = tracking.signals()[0].lock_since;
  tracking.command_slip(Signal::kGpsL1, -3, false);
  tracking.update(at(30), false, {45.0, 42.0});
  EXPECT_EQ(tracking.signals()[0].ambiguity_cycles, before - 3);
  EXPECT_EQ(tracking.signals()[0].lock_since, lock);  // unseen: the count goes on
  tracking.command_slip(Signal::kGpsL1, 5, true);
  tracking.update(at(31), false, {45.0, 42.0});
  EXPECT_EQ(tracking.signals()[0].ambiguity_cycles, before + 2);
  EXPECT_EQ(tracking.signals()[0].lock_since, at(31));
  EXPECT_EQ(tracking.signals()[0].slips, 2);
  EXPECT_EQ(tracking.signals()[1].slips, 0);
}

// 100 slips an hour over 20 hours: 2000 events of a Poisson process, within 4 sqrt(2000); a quarter unseen.
TEST(Tracking, SlipsAtItsRate) {
  TrackingSettings settings;
  settings.cycle_slips_per_hour = 100.0;
  settings.undetected_slip_fraction = 0.25;
  SatelliteTracking tracking(kG05, {}, settings, 1, "test");
  int unseen = 0;
  int slips = 0;
  for (int t = 0; t < 72000; ++t) {
    tracking.update(at(t), t == 0, {45.0, 42.0});
    const SignalTrack& track = tracking.signals()[0];
    if (track.slips > slips && track.lock_since != at(t)) ++unseen;
    slips = track.slips;
  }
  EXPECT_NEAR(slips, 2000, 180);
  EXPECT_NEAR(static_cast<double>(unseen) / slips, 0.25, 0.04);  // 4 sigma
}

}  // namespace

}  // namespace vbar::twins::gnss
