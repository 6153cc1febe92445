#include "hil_drivers/tron/bench/controller/servo.h"

#include <cmath>

#include <gtest/gtest.h>

#include "hil_drivers/tron/bench/controller/axis_monitor.h"

namespace vbar::tron::bench {
namespace {

constexpr double kCycle_s = 0.004;

AxisArray filled(double value) {
  AxisArray values;
  values.fill(value);
  return values;
}

// TRON bench: second order, lag 8 ms. A critically damped system follows a ramp of slope s by 2 s / frequency.
TEST(Servo, FollowsARampWithALagOfEightMilliseconds) {
  Servo servo(filled(0.0), filled(1.0), kCycle_s);
  constexpr double kSpeed = 1.5;
  for (int k = 1; k <= 200; ++k) servo.follow(filled(kSpeed * kCycle_s * k));
  for (const double position : servo.position()) EXPECT_NEAR(kSpeed * (200 * kCycle_s - 0.008), position, 1e-12);
  EXPECT_FALSE(servo.stands());
}

TEST(Servo, ReachesAStepWithoutOvershoot) {
  Servo servo(filled(0.0), filled(1.0), kCycle_s);
  double last = 0.0;
  for (int k = 0; k < 100; ++k) {
    servo.follow(filled(1.0));
    EXPECT_GE(servo.position()[3], last);
    EXPECT_LE(servo.position()[3], 1.0);
    last = servo.position()[3];
  }
  EXPECT_NEAR(1.0, last, 1e-12);
  EXPECT_TRUE(servo.stands());
}

TEST(Servo, BrakesEachAxisAtItsDeceleration) {
  AxisArray deceleration = filled(2.0);
  deceleration[1] = 0.5;
  Servo servo(filled(0.0), deceleration, kCycle_s);
  for (int k = 1; k <= 100; ++k) servo.follow(filled(kCycle_s * k));  // 1 rad/s
  for (int k = 0; k < 1000; ++k) servo.brake();
  EXPECT_TRUE(servo.stands());
  // v^2 / (2 a), of a speed that falls in steps of a cycle: shorter by half a step of the speed, v t / 2.
  EXPECT_NEAR(0.4 + 0.25 - 0.002, servo.position()[0], 1e-9);
  EXPECT_NEAR(0.4 + 1.0 - 0.002, servo.position()[1], 1e-9);
}

AxisMonitor monitor_of(double speed, double acceleration) {
  std::array<AxisLimits, kServoAxes> limits{};
  limits.fill({-1.0, 1.0, speed, acceleration, 0.0});
  return {limits, kCycle_s};
}

TEST(AxisMonitor, NamesTheAxisAndTheLimit) {
  AxisMonitor position = monitor_of(1e3, 1e6);
  position.begin(filled(0.9));
  AxisArray command = filled(0.9);
  command[2] = 1.01;
  EXPECT_EQ("software limit of A3: 57.8687", position.judge(command, 1));

  AxisMonitor speed = monitor_of(0.5, 1e6);
  speed.begin(filled(0.0));
  command = filled(0.0);
  command[kTrackAxis] = 0.003;
  EXPECT_EQ("speed of E1 above its limit: 750.0000 of 500.0000 a second", speed.judge(command, 1));

  AxisMonitor acceleration = monitor_of(1.0, 50.0);
  acceleration.begin(filled(0.0));
  command = filled(0.0);
  command[0] = 0.003;  // 0.75 rad/s in a cycle: 187.5 rad/s2
  EXPECT_EQ("acceleration of A1 above its limit: 10742.9587 of 2864.7890 a second squared",
            acceleration.judge(command, 1));
  EXPECT_NEAR(187.5, acceleration.max_acceleration()[0], 1e-9);
  EXPECT_NEAR(0.75, acceleration.max_speed()[0], 1e-12);
}

TEST(AxisMonitor, RefusesNan) {
  AxisMonitor monitor = monitor_of(1e3, 1e6);
  monitor.begin(filled(0.0));
  AxisArray command = filled(0.0);
  command[5] = std::nan("");
  EXPECT_FALSE(monitor.judge(command, 1).empty());
}

TEST(AxisMonitor, AcceptsTheRoundingOfTheWire) {
  // 50 deg/s rounded to four decimals of a degree, with A2's acceleration: the speed of successive cycles differs by up
  // to two roundings, 0.025 deg/s in 4 ms.
  AxisMonitor monitor = monitor_of(1.0, 0.01);
  monitor.begin(filled(0.0));
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  for (int k = 1; k <= 50; ++k) {
    const double degrees = std::round(0.5 * 0.01 / kDegree * std::pow(k * kCycle_s, 2) * 1e4) / 1e4;
    AxisArray command = filled(degrees * kDegree);
    command[kTrackAxis] = 0.0;  // whose units are others
    EXPECT_EQ("", monitor.judge(command, 1)) << k;
  }
}

TEST(AxisMonitor, JudgesOnlyTheMeanSpeedOverAGap) {
  AxisMonitor monitor = monitor_of(1.0, 1.73);
  monitor.begin(filled(0.0));
  EXPECT_EQ("", monitor.judge(filled(0.0), 1));
  EXPECT_EQ("", monitor.judge(filled(0.011), 3));  // 0.92 rad/s
  EXPECT_EQ("", monitor.judge(filled(0.013), 1));  // no speed before it
  EXPECT_NE("", monitor.judge(filled(0.013), 1));  // 0.5 rad/s to 0 in a cycle
  monitor.begin(filled(0.0));
  EXPECT_NE("", monitor.judge(filled(0.013), 30));  // as if after three cycles
}

}  // namespace
}  // namespace vbar::tron::bench
