#include "fsw/guard/guard.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::guard {
namespace {

constexpr int kSidePx = 300;
constexpr GuardCamera kCamera{.focal_length_px = 6000.0, .dark_level_dn = 0.0, .noise_dn = 2.0};
constexpr GuardSettings kSettings{.target_size_m = 0.7, .data_timeout_s = 2100.0, .data_timeout_range_m = 100.0};
const Illumination kFullLight{.line_of_sight = Vector3::UnitZ(), .to_sun = -Vector3::UnitZ()};

GpsTime at(double s) {
  return GpsTime{} + nearest_duration(s);
}

class GuardTest : public ::testing::Test {
 protected:
  GuardTest() { guard_.configure(kSettings); }

  /// An image of the target at a distance; what navigation states.
  void look(double s, double true_range_m, double navigation_range_m) {
    std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kSidePx * kSidePx));
    const int side = static_cast<int>(std::lround(6000.0 * 0.7 * 0.9 / true_range_m));
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) pixels[static_cast<std::size_t>((y + 10) * kSidePx + x + 10)] = 2000;
    }
    guard_.take_image(at(s), {.frame = {.width = kSidePx, .height = kSidePx}, .pixels = pixels}, kCamera, kFullLight,
                      navigation_range_m);
  }

  Guard guard_;
};

TEST_F(GuardTest, AgreesWithTheTruth) {
  look(0.0, 40.0, 40.0);
  const GuardVerdicts verdicts = guard_.judge(at(1.0));
  EXPECT_TRUE(verdicts.range.is_checked);
  EXPECT_FALSE(verdicts.range.is_alarm);
  EXPECT_NEAR(verdicts.range.value, 0.0, 0.01);
  EXPECT_FALSE(guard_.judge(at(2.0)).range.is_checked) << "an image is judged once";
}

TEST_F(GuardTest, ARangeThatNavigationStatesWronglyForMinutesIsAnAlarm) {
  for (const double stated_m : {95.0, 17.0}) {
    guard_ = Guard();
    guard_.configure(kSettings);
    for (double t = 0.0; t < 600.0; t += 20.0) {
      look(t, 40.0, stated_m);
      EXPECT_EQ(guard_.judge(at(t)).range.is_alarm, t >= Guard::kLongestDisagreement_s) << stated_m << " m, " << t;
    }
  }
}

TEST_F(GuardTest, AnImageThatAgreesEndsTheAlarm) {
  for (double t = 0.0; t <= 1000.0; t += 20.0) {
    look(t, 40.0, t == 280.0 || t == 560.0 || t == 840.0 ? 50.0 : 95.0);
    EXPECT_FALSE(guard_.judge(at(t)).range.is_alarm) << "an attitude may do that, " << t;
  }
}

TEST_F(GuardTest, RareImagesAreAnAlarmFromTheFifthOn) {
  for (int k = 0; k < 8; ++k) {
    look(300.0 * k, 40.0, 95.0);
    EXPECT_EQ(guard_.judge(at(300.0 * k)).range.is_alarm, k >= 4) << k;
  }
}

// Two disagreements with an eclipse between them are two.
TEST_F(GuardTest, ALongGapBeginsAnew) {
  look(0.0, 40.0, 95.0);
  EXPECT_FALSE(guard_.judge(at(0.0)).range.is_alarm);
  look(2000.0, 40.0, 95.0);
  EXPECT_FALSE(guard_.judge(at(2000.0)).range.is_alarm);
}

TEST_F(GuardTest, FarFromTheTargetNothingIsCompared) {
  look(0.0, 200.0, 400.0);
  EXPECT_FALSE(guard_.judge(at(1.0)).range.is_checked);
  for (double t = 5.0; t <= 305.0; t += 20.0) look(t, 200.0, 80.0);
  EXPECT_TRUE(guard_.judge(at(306.0)).range.is_alarm) << "navigation claims to be near";
}

TEST_F(GuardTest, SilenceNearTheTargetIsAnAlarm) {
  look(0.0, 40.0, 40.0);
  EXPECT_FALSE(guard_.judge(at(2100.0)).silence.is_alarm);
  EXPECT_TRUE(guard_.judge(at(2101.0)).silence.is_alarm);
}

// 35 minutes of eclipse and ten minutes of the target's dark side follow one another in a nominal mission.
TEST_F(GuardTest, AnEclipseDelaysTheAlarmUntilHalfTheTimeoutWasLit) {
  look(0.0, 40.0, 40.0);
  for (double t = 60.0; t <= 3600.0; t += 60.0) {
    guard_.take_sunlight(at(t - 5.0), t < 300.0 || t > 2340.0);
    EXPECT_EQ(guard_.judge(at(t)).silence.is_alarm, t > 2340.0 + 1050.0 - 240.0) << t;
  }
}

// Eclipses of a quarter of an hour leave enough light in the timeout.
TEST_F(GuardTest, AShortEclipseDelaysNothing) {
  look(0.0, 40.0, 40.0);
  for (double t = 60.0; t <= 3600.0; t += 60.0) {
    guard_.take_sunlight(at(t), t < 600.0 || t > 1440.0);
    EXPECT_EQ(guard_.judge(at(t)).silence.is_alarm, t > 2100.0) << t;
  }
}

TEST_F(GuardTest, AReceiverThatFailsInEclipseDelaysNothing) {
  look(0.0, 40.0, 40.0);
  guard_.take_sunlight(at(10.0), false);
  for (double t = 60.0; t <= 3600.0; t += 60.0) EXPECT_EQ(guard_.judge(at(t)).silence.is_alarm, t > 2100.0) << t;
}

// A target with its dark side towards the camera is not seen, but heard.
TEST_F(GuardTest, ACodeBaselineEndsASilence) {
  look(0.0, 40.0, 40.0);
  guard_.take_code_baseline(at(2000.0), 41.0, 40.0);
  EXPECT_FALSE(guard_.judge(at(2101.0)).silence.is_alarm);
  guard_.take_code_baseline(at(1000.0), 41.0, 40.0);
  EXPECT_FALSE(guard_.judge(at(4100.0)).silence.is_alarm) << "an older one does not count";
  EXPECT_TRUE(guard_.judge(at(4101.0)).silence.is_alarm);
}

TEST_F(GuardTest, ACodeBaselineContradictsNavigationUnlessItIsShort) {
  bool is_alarm = false;
  for (double t = 0.0; t <= 400.0; t += 10.0) {
    guard_.take_code_baseline(at(t), 40.0, 95.0);
    is_alarm = guard_.judge(at(t)).range.is_alarm;
    EXPECT_EQ(is_alarm, t >= Guard::kLongestDisagreement_s) << t;
  }
  guard_ = Guard();
  guard_.configure(kSettings);
  for (double t = 0.0; t <= 400.0; t += 10.0) {
    guard_.take_code_baseline(at(t), 9.0, 3.0);
    EXPECT_FALSE(guard_.judge(at(t)).range.is_checked) << "codes are wrong by metres";
  }
}

TEST_F(GuardTest, SilenceFarAwayIsNone) {
  EXPECT_FALSE(guard_.judge(at(1e5)).silence.is_checked) << "there never was a range";
  look(0.0, 140.0, 140.0);
  EXPECT_FALSE(guard_.judge(at(9000.0)).silence.is_alarm);
}

TEST_F(GuardTest, ABurnThatDiffersFromItsCommandIsAnAlarm) {
  guard_.take_command(4, {0.0, 1e-3, 0.0});
  guard_.take_report(4, {0.0, 0.9e-3, 0.0});
  EXPECT_FALSE(guard_.judge(at(0.0)).burns.is_alarm);
  guard_.take_command(5, {0.0, 1e-3, 0.0});
  guard_.take_report(5, {0.0, 0.7e-3, 0.0});
  EXPECT_TRUE(guard_.judge(at(1.0)).burns.is_alarm);
  guard_.take_report(99, {0.0, 1e-2, 0.0});
  EXPECT_TRUE(guard_.judge(at(2.0)).burns.is_alarm) << "nobody commanded it";
}

// 140 m at 0.3 m/s: the whole range in eight minutes.
TEST_F(GuardTest, AFastApproachIsAnAlarm) {
  bool is_alarm = false;
  for (int k = 0; k < 500 && !is_alarm; ++k) {
    const double t = 5.0 * k;
    const double range_m = t < 1500.0 ? 140.0 : 140.0 - 0.3 * (t - 1500.0);
    if (range_m < 20.0) break;
    look(t, range_m, range_m);
    const Verdict closing = guard_.judge(at(t)).closing;
    if (t <= 1500.0) {
      EXPECT_FALSE(closing.is_alarm) << t;
    }
    is_alarm = closing.is_alarm;
  }
  EXPECT_TRUE(is_alarm);
}

}  // namespace
}  // namespace vbar::fsw::guard
