#include "hil_drivers/tron/rsi/client/command_check.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::tron::rsi {
namespace {

using testing::StartsWith;

CommandCheck check_of(double speed, double acceleration) {
  std::array<CommandLimits, kWireAxes> axes{};
  axes.fill({-2.0, 2.0, speed, acceleration, {-60.0, 60.0, 0}});
  return {axes, CommandLimits{-3.5, 3.5, 1.0, 0.8, {-7000.0, 7000.0, 0}}};
}

AxisPositions at(int axis, double value) {
  AxisPositions positions;
  positions.axes_rad[axis] = value;
  return positions;
}

TEST(CommandCheck, NamesAxisValueAndLimit) {
  CommandCheck check = check_of(1.0, 10.0);
  check.begin(at(2, 0.5));
  // 0.0041 rad in 4 ms: 1.025 rad/s.
  EXPECT_EQ("A3: speed 58.7282 deg/s; accepted: up to 57.2958", check.advance(at(2, 0.5041)));
  // 0.001 rad in the first cycle: 62.5 rad/s2.
  EXPECT_EQ("A3: acceleration 3580.9862 deg/s2; accepted: up to 572.9578", check.advance(at(2, 0.501)));
  EXPECT_EQ("", check.advance(at(2, 0.5 + 9.9 * 16e-6)));
  EXPECT_EQ("", check.advance(at(2, 0.5 + 3 * 9.9 * 16e-6)));
  // Refused commands have left no trace: the next one is judged from the last accepted.
  EXPECT_THAT(check.advance(at(2, 0.5)), StartsWith("A3: acceleration"));
  EXPECT_DOUBLE_EQ(0.5 + 3 * 9.9 * 16e-6, check.last().axes_rad[2]);
  EXPECT_DOUBLE_EQ(0.5, check.zero().axes_rad[2]);
}

TEST(CommandCheck, RefusesPositionsAndCorrectionsBeyondTheirRange) {
  CommandCheck fast = check_of(1e6, 1e9);
  fast.begin({});
  EXPECT_THAT(fast.advance(at(1, 2.1)), StartsWith("A2: position 120.3211 deg; accepted: -114.5916 to 114.5916"));
  EXPECT_THAT(fast.advance(at(1, -1.1)), StartsWith("A2: correction -63.0254 deg; accepted: -60.0000 to 60.0000"));
  AxisPositions track;
  track.track_m = 3.6;
  EXPECT_THAT(fast.advance(track), StartsWith("E1: position 3600.0000 mm"));
  EXPECT_EQ("", fast.advance(at(1, 1.0)));
}

TEST(CommandCheck, AnAxisBeyondItsRangeMayComeBack) {
  CommandCheck check = check_of(1e6, 1e9);
  check.begin(at(0, 2.001));
  EXPECT_EQ("", check.advance(at(0, 2.001)));
  EXPECT_THAT(check.advance(at(0, 2.002)), StartsWith("A1: position"));
  EXPECT_EQ("", check.advance(at(0, 2.0005)));
}

TEST(CommandCheck, RefusesNan) {
  CommandCheck check = check_of(1e6, 1e9);
  check.begin({});
  EXPECT_THAT(check.advance(at(4, std::nan(""))), StartsWith("A5: position nan"));
  EXPECT_THAT(check.advance(at(4, std::numeric_limits<double>::infinity())), StartsWith("A5: position inf"));
  AxisPositions track;
  track.track_m = std::nan("");
  EXPECT_THAT(check.advance(track), StartsWith("E1: position nan"));
}

}  // namespace
}  // namespace vbar::tron::rsi
