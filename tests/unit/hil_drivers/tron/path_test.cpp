// Paths cycle by cycle: limits of every axis as a controller sees them, and a stop after every cycle.

#include "hil_drivers/tron/motion_planning/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/collision.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

constexpr double kCycle_s = 0.004;

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

using Axes = Eigen::Matrix<double, 13, 1>;

Axes axes_of(const Posture& posture) {
  Axes axes;
  axes << posture.camera_rad, posture.target_rad, posture.carriage_m;
  return axes;
}

Axes limits_of(double AxisLimits::*limit) {
  const TestbedDesign file = bench();
  Axes limits;
  for (int k = 0; k < 6; ++k) {
    limits[k] = file.camera_robot.design.axes[static_cast<std::size_t>(k)].*limit;
    limits[6 + k] = file.target_robot.design.axes[static_cast<std::size_t>(k)].*limit;
  }
  limits[12] = file.track.axis.*limit;
  return file.motion.override_fraction * limits;
}

Posture start() {
  return {Joints(0.1, -1.4, 1.2, 0.5, 0.7, -0.6), Joints(-0.2, -1.6, 1.5, -0.4, 0.8, 0.3), 3.0};
}

Posture away() {
  return {Joints(0.4, -1.2, 1.3, 0.1, 0.9, 1.6), Joints(-0.9, -1.1, 1.0, 0.9, -0.3, 0.2), 3.4};
}

Path two_legs() {
  const TestbedAxisLimits limits(bench());
  Path path(start());
  path.go_to(away(), limits, kCycle_s);
  path.go_to(start(), limits, kCycle_s);
  return path;
}

/// Differences from cycle to cycle, at rest before `first`, which begins with the history of `path`.
void expect_within_limits(const std::vector<Axes>& places) {
  const Axes speed = limits_of(&AxisLimits::speed), acceleration = limits_of(&AxisLimits::acceleration),
             jerk = limits_of(&AxisLimits::jerk);
  for (std::size_t k = 3; k < places.size(); ++k) {
    const Axes v = (places[k] - places[k - 1]) / kCycle_s;
    const Axes a = (places[k] - 2.0 * places[k - 1] + places[k - 2]) / (kCycle_s * kCycle_s);
    const Axes j =
        (places[k] - 3.0 * places[k - 1] + 3.0 * places[k - 2] - places[k - 3]) / (kCycle_s * kCycle_s * kCycle_s);
    // Rounding of places of some units, 1e-15, over 4 ms, its square and its cube.
    ASSERT_TRUE((v.cwiseAbs().array() <= speed.array() + 1e-11).all()) << k;
    ASSERT_TRUE((a.cwiseAbs().array() <= acceleration.array() + 1e-9).all()) << k;
    ASSERT_TRUE((j.cwiseAbs().array() <= jerk.array() + 1e-6).all()) << k;
  }
}

TEST(TronPath, KeepsTheLimitsOfEveryAxisInEveryCycle) {
  const Path path = two_legs();
  ASSERT_GT(path.cycles(), 100);
  std::vector<Axes> places(4, axes_of(path.at(0)));
  for (int cycle = 1; cycle <= path.cycles() + 4; ++cycle) places.push_back(axes_of(path.at(cycle)));
  expect_within_limits(places);
  EXPECT_EQ(axes_of(path.at(0)), axes_of(start()));
  EXPECT_EQ(axes_of(path.at(path.cycles())), axes_of(start()));
  EXPECT_EQ(axes_of(path.at(path.cycles() + 1000)), axes_of(start()));
}

TEST(TronPath, TheSlowestAxisIsAtALimit) {
  const TestbedAxisLimits limits(bench());
  Path path(start());
  path.go_to(away(), limits, kCycle_s);
  const Axes way = axes_of(away()) - axes_of(start());
  const Axes acceleration = limits_of(&AxisLimits::acceleration), jerk = limits_of(&AxisLimits::jerk);
  // A longer motion would be allowed only if no axis had to be faster than this: T = sqrt((a/j)^2 + 4 d / a) + a / j.
  accuracy::Largest longest;
  for (int k = 0; k < 13; ++k) {
    const double d = std::abs(way[k]), a = acceleration[k], j = jerk[k];
    longest.add(std::sqrt(a * a / (j * j) + 4.0 * d / a) + a / j);
  }
  EXPECT_NEAR(path.cycles() * kCycle_s, longest, 0.05 * longest);
}

TEST(TronPath, StopsAfterEveryCycleOnThePath) {
  const Path path = two_legs();
  const Axes way = axes_of(away()) - axes_of(start());
  for (int cycle = 0; cycle <= path.cycles(); ++cycle) {
    const Path stop = path.stop_after(cycle);
    ASSERT_EQ(axes_of(stop.at(0)), axes_of(path.at(cycle))) << cycle;
    std::vector<Axes> places(4, axes_of(path.at(0)));
    for (int k = 1; k <= cycle; ++k) places.push_back(axes_of(path.at(k)));
    for (int k = 1; k <= stop.cycles() + 4; ++k) places.push_back(axes_of(stop.at(k)));
    expect_within_limits(places);
    // On the straight line of the leg, between its ends.
    const Axes left = axes_of(stop.end()) - axes_of(start());
    const double share = left.dot(way) / way.squaredNorm();
    ASSERT_LT((left - share * way).norm(), 1e-12);
    ASSERT_GE(share, -1e-12);
    ASSERT_LE(share, 1.0 + 1e-12);
    ASSERT_LE(stop.cycles(), path.cycles() - cycle + 1);
    // A stop can be stopped again, and stays where it is.
    const Path again = stop.stop_after(stop.cycles() / 2);
    ASSERT_LE(again.cycles(), stop.cycles() - stop.cycles() / 2 + 1);
  }
}

TEST(TronPath, NowhereToGoTakesNoCycles) {
  Path path(start());
  EXPECT_EQ(path.cycles(), 0);
  path.go_to(start(), TestbedAxisLimits(bench()), kCycle_s);
  EXPECT_EQ(path.cycles(), 0);
  EXPECT_EQ(axes_of(path.at(7)), axes_of(start()));
  EXPECT_EQ(path.stop_after(3).cycles(), 0);
}

TEST(TronPath, RefusesAPostureThatIsNotFinite) {
  Path path(start());
  Posture bad = away();
  bad.target_rad[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(path.go_to(bad, TestbedAxisLimits(bench()), kCycle_s), std::invalid_argument);
}

}  // namespace

// Paths that are free, that need a detour, and that there are none of. Judged by finer samples than the planner's.

namespace {

Posture home(const TestbedDesign& file) {
  return {Joints::Map(file.camera_robot.home_rad.data()), Joints::Map(file.target_robot.home_rad.data()),
          file.track.home_m};
}

void expect_free(const Path& path, const TestbedBodies& bodies) {
  for (int cycle = 0; cycle <= path.cycles(); ++cycle)
    ASSERT_EQ(bodies.collision(bodies.at(path.at(cycle)), 0.8 * bodies.clearance_m()), "") << cycle;
}

TEST(TronPathPlanner, TheHomePostureIsFreeAlongTheTrack) {
  const TestbedDesign file = bench();
  const TestbedBodies bodies(file);
  const PathPlanner planner(file, bodies);
  Posture to = home(file);
  to.carriage_m = 3.0;
  const auto path = planner.plan(home(file), to);
  ASSERT_TRUE(std::holds_alternative<Path>(path)) << std::get<PathFailure>(path).reason;
  expect_free(std::get<Path>(path), bodies);
}

TEST(TronPathPlanner, GoesOverARetractedPostureWhereTheStraightPathIsBlocked) {
  const TestbedDesign file = bench();
  const TestbedBodies bodies(file);
  const PathPlanner planner(file, bodies);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto drawn = [&] {
    Posture at = home(file);
    for (int k = 0; k < 6; ++k) {
      at.camera_rad[k] += 0.9 * uniform(random);
      at.target_rad[k] += 0.9 * uniform(random);
    }
    at.target_rad[0] = 2.8 * uniform(random);
    at.carriage_m = 5.8 + 0.5 * uniform(random);
    return at;
  };
  int detours = 0;
  for (int n = 0; n < 3000 && detours < 5; ++n) {
    const Posture from = drawn(), to = drawn();
    if (!bodies.is_free(bodies.at(from)) || !bodies.is_free(bodies.at(to)) || planner.is_straight_free(from, to))
      continue;
    const auto path = planner.plan(from, to);
    if (!std::holds_alternative<Path>(path)) continue;
    ++detours;
    expect_free(std::get<Path>(path), bodies);
    EXPECT_EQ(std::get<Path>(path).end().target_rad, to.target_rad);
    EXPECT_EQ(std::get<Path>(path).end().camera_rad, to.camera_rad);
  }
  EXPECT_GT(detours, 0);
}

TEST(TronPathPlanner, RefusesEndsThatCannotBe) {
  const TestbedDesign file = bench();
  const TestbedBodies bodies(file);
  const PathPlanner planner(file, bodies);
  const auto reason = [&](const Posture& to) {
    const auto path = planner.plan(home(file), to);
    return std::holds_alternative<PathFailure>(path) ? std::get<PathFailure>(path).reason : "";
  };
  Posture to = home(file);
  to.camera_rad[0] = 3.1;
  EXPECT_NE(reason(to).find("limit of the camera's arm"), std::string::npos);
  to = home(file);
  to.carriage_m = 7.6;
  EXPECT_NE(reason(to).find("beyond the track"), std::string::npos);
  to = home(file);
  to.camera_rad[3] = 3.0;
  to.camera_rad[5] = 4.0;
  EXPECT_NE(reason(to).find("cable"), std::string::npos);
  to = home(file);
  to.target_rad = Joints(0.0, 0.7, 0.5, 0.0, 0.0, 0.0);  // into the floor
  EXPECT_NE(reason(to).find("closer than"), std::string::npos);
  to = home(file);
  to.carriage_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason(to).find("not finite"), std::string::npos);
  const auto from_nowhere = planner.plan(to, home(file));
  EXPECT_TRUE(std::holds_alternative<PathFailure>(from_nowhere));
}

}  // namespace

// Limited progress from rest to rest: durations of cases that can be worked out, limits everywhere, stops at any
// moment.

namespace {

constexpr ProgressLimits kLimits{2.0, 4.0, 40.0};

void expect_within_limits(const SCurve& curve, double end, double first_place) {
  constexpr int kSteps = 2000;
  double last = first_place;
  for (int k = 0; k <= kSteps; ++k) {
    const Progress at = curve.at(curve.duration_s() * k / kSteps);
    // Of rounding in sums of cubic polynomials.
    ASSERT_LE(at.speed, kLimits.speed + 1e-12);
    ASSERT_GE(at.speed, -1e-9);
    ASSERT_LE(std::abs(at.acceleration), kLimits.acceleration + 1e-12);
    ASSERT_GE(at.place, last - 1e-12);
    ASSERT_LE(at.place, end + 1e-12);
    last = at.place;
  }
}

TEST(TronSCurve, DurationsOfTheFourShapes) {
  // Cruising: distance / speed + speed / acceleration + acceleration / jerk.
  EXPECT_NEAR(rest_to_rest_s(10.0, kLimits), 10.0 / 2.0 + 2.0 / 4.0 + 4.0 / 40.0, 1e-12);
  // The acceleration is reached, the speed is not: T = sqrt((a/j)^2 + 4 d / a) + a / j.
  EXPECT_NEAR(rest_to_rest_s(0.5, kLimits), std::sqrt(0.01 + 4.0 * 0.5 / 4.0) + 0.1, 1e-12);
  // Neither: four ramps of cbrt(d / 2 j).
  EXPECT_NEAR(rest_to_rest_s(0.001, kLimits), 4.0 * std::cbrt(0.001 / 80.0), 1e-12);
  // The speed is reached before the acceleration is: two ramps of sqrt(v / j) on either side.
  const ProgressLimits slow{0.1, 4.0, 40.0};
  EXPECT_NEAR(rest_to_rest_s(1.0, slow), 1.0 / 0.1 + 2.0 * std::sqrt(0.1 / 40.0), 1e-12);
  EXPECT_EQ(rest_to_rest_s(0.0, kLimits), 0.0);
}

TEST(TronSCurve, GoesFromRestToRestWithinLimits) {
  for (const double distance : {1e-6, 0.001, 0.02, 0.1, 0.5, 1.0, 1.2, 10.0}) {
    const SCurve curve = SCurve::rest_to_rest(distance, kLimits);
    EXPECT_NEAR(curve.duration_s(), rest_to_rest_s(distance, kLimits), 1e-12);
    expect_within_limits(curve, distance, 0.0);
    EXPECT_EQ(curve.at(curve.duration_s()).place, distance);
    const Progress before_end = curve.at(curve.duration_s() * (1.0 - 1e-9));
    EXPECT_NEAR(before_end.place, distance, 1e-9 * distance);
    EXPECT_NEAR(before_end.speed, 0.0, 1e-6);
  }
}

TEST(TronSCurve, StopsFromAnyMomentNotBeyondTheEnd) {
  for (const double distance : {0.001, 0.1, 0.5, 10.0}) {
    const SCurve curve = SCurve::rest_to_rest(distance, kLimits);
    for (int k = 0; k <= 500; ++k) {
      const double time_s = curve.duration_s() * k / 500.0;
      const Progress from = curve.at(time_s);
      const SCurve stop = curve.stop_at(time_s);
      expect_within_limits(stop, distance, from.place);
      EXPECT_NEAR(stop.at(0.0).place, from.place, 1e-12);
      EXPECT_NEAR(stop.at(0.0).speed, from.speed, 1e-12);
      // Not longer than the motion itself, and than the slowest stop: speed / acceleration + 2 ramps.
      EXPECT_LE(stop.duration_s(), curve.duration_s() - time_s + 1e-6);
      EXPECT_LE(stop.duration_s(), 2.0 / 4.0 + 2.0 * 0.1 + 1e-9);
      const Progress almost = stop.at(stop.duration_s() * (1.0 - 1e-9));
      EXPECT_NEAR(almost.speed, 0.0, 1e-6);
      EXPECT_NEAR(almost.place, stop.at(stop.duration_s()).place, 1e-6);
    }
  }
}

}  // namespace

}  // namespace vbar::tron
