// Paths cycle by cycle: limits of every axis as a controller sees them, and a stop after every cycle.

#include "hil_drivers/tron/motion/path.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

constexpr double kCycle_s = 0.004;

BenchFile bench() {
  return read_bench_file(tests::source_path("data/benches/tron.toml"));
}

using Axes = Eigen::Matrix<double, 13, 1>;

Axes axes_of(const Posture& posture) {
  Axes axes;
  axes << posture.camera_rad, posture.target_rad, posture.carriage_m;
  return axes;
}

Axes limits_of(double AxisLimits::*limit) {
  const BenchFile file = bench();
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
  const AxisLimitsOfBench limits(bench());
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
  const AxisLimitsOfBench limits(bench());
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
  path.go_to(start(), AxisLimitsOfBench(bench()), kCycle_s);
  EXPECT_EQ(path.cycles(), 0);
  EXPECT_EQ(axes_of(path.at(7)), axes_of(start()));
  EXPECT_EQ(path.stop_after(3).cycles(), 0);
}

TEST(TronPath, RefusesAPostureThatIsNotFinite) {
  Path path(start());
  Posture bad = away();
  bad.target_rad[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(path.go_to(bad, AxisLimitsOfBench(bench()), kCycle_s), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron
