#include "host_sim/twins/gnss/tracking.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::twins::gnss {
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
