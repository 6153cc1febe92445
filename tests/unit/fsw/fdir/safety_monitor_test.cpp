#include "fsw/fdir/safety_monitor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::fsw::fdir {

namespace {

constexpr int kSidePx = 300;
constexpr SafetyMonitorCamera kCamera{.focal_length_px = 6000.0, .dark_level_dn = 0.0, .noise_dn = 2.0};
constexpr SafetyMonitorSettings kSettings{
    .target_size_m = 0.7, .data_timeout_s = 2100.0, .data_timeout_range_m = 100.0};
const Illumination kFullLight{.line_of_sight = Vector3::UnitZ(), .to_sun = -Vector3::UnitZ()};

GpsTime at(double s) {
  return GpsTime{} + nearest_duration(s);
}

class SafetyMonitorTest : public ::testing::Test {
 protected:
  SafetyMonitorTest() { safety_monitor_.configure(kSettings); }

  /// An image of the target at a distance; what navigation states.
  void look(double s, double true_range_m, double navigation_range_m) {
    std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kSidePx * kSidePx));
    const int side = static_cast<int>(std::lround(6000.0 * 0.7 * 0.9 / true_range_m));
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) pixels[static_cast<std::size_t>((y + 10) * kSidePx + x + 10)] = 2000;
    }
    safety_monitor_.take_image(at(s), {.frame = {.width = kSidePx, .height = kSidePx}, .pixels = pixels}, kCamera,
                               kFullLight, navigation_range_m);
  }

  SafetyMonitor safety_monitor_;
};

TEST_F(SafetyMonitorTest, AgreesWithTheTruth) {
  look(0.0, 40.0, 40.0);
  const SafetyMonitorVerdicts verdicts = safety_monitor_.judge(at(1.0));
  EXPECT_TRUE(verdicts.range.is_checked);
  EXPECT_FALSE(verdicts.range.is_alarm);
  EXPECT_NEAR(verdicts.range.value, 0.0, 0.01);
  EXPECT_FALSE(safety_monitor_.judge(at(2.0)).range.is_checked) << "an image is judged once";
}

TEST_F(SafetyMonitorTest, ARangeThatNavigationStatesWronglyForMinutesIsAnAlarm) {
  for (const double stated_m : {95.0, 17.0}) {
    safety_monitor_ = SafetyMonitor();
    safety_monitor_.configure(kSettings);
    for (double t = 0.0; t < 600.0; t += 20.0) {
      look(t, 40.0, stated_m);
      EXPECT_EQ(safety_monitor_.judge(at(t)).range.is_alarm, t >= SafetyMonitor::kLongestDisagreement_s)
          << stated_m << " m, " << t;
    }
  }
}

TEST_F(SafetyMonitorTest, AnImageThatAgreesEndsTheAlarm) {
  for (double t = 0.0; t <= 1000.0; t += 20.0) {
    look(t, 40.0, t == 280.0 || t == 560.0 || t == 840.0 ? 50.0 : 95.0);
    EXPECT_FALSE(safety_monitor_.judge(at(t)).range.is_alarm) << "an attitude may do that, " << t;
  }
}

TEST_F(SafetyMonitorTest, RareImagesAreAnAlarmFromTheFifthOn) {
  for (int k = 0; k < 8; ++k) {
    look(300.0 * k, 40.0, 95.0);
    EXPECT_EQ(safety_monitor_.judge(at(300.0 * k)).range.is_alarm, k >= 4) << k;
  }
}

// Two disagreements with an eclipse between them are two.
TEST_F(SafetyMonitorTest, ALongGapBeginsAnew) {
  look(0.0, 40.0, 95.0);
  EXPECT_FALSE(safety_monitor_.judge(at(0.0)).range.is_alarm);
  look(2000.0, 40.0, 95.0);
  EXPECT_FALSE(safety_monitor_.judge(at(2000.0)).range.is_alarm);
}

TEST_F(SafetyMonitorTest, FarFromTheTargetNothingIsCompared) {
  look(0.0, 200.0, 400.0);
  EXPECT_FALSE(safety_monitor_.judge(at(1.0)).range.is_checked);
  for (double t = 5.0; t <= 305.0; t += 20.0) look(t, 200.0, 80.0);
  EXPECT_TRUE(safety_monitor_.judge(at(306.0)).range.is_alarm) << "navigation claims to be near";
}

TEST_F(SafetyMonitorTest, SilenceNearTheTargetIsAnAlarm) {
  look(0.0, 40.0, 40.0);
  EXPECT_FALSE(safety_monitor_.judge(at(2100.0)).silence.is_alarm);
  EXPECT_TRUE(safety_monitor_.judge(at(2101.0)).silence.is_alarm);
}

// 35 minutes of eclipse and ten minutes of the target's dark side follow one another in a nominal mission.
TEST_F(SafetyMonitorTest, AnEclipseDelaysTheAlarmUntilHalfTheTimeoutWasLit) {
  look(0.0, 40.0, 40.0);
  for (double t = 60.0; t <= 3600.0; t += 60.0) {
    safety_monitor_.take_sunlight(at(t - 5.0), t < 300.0 || t > 2340.0);
    EXPECT_EQ(safety_monitor_.judge(at(t)).silence.is_alarm, t > 2340.0 + 1050.0 - 240.0) << t;
  }
}

// Eclipses of a quarter of an hour leave enough light in the timeout.
TEST_F(SafetyMonitorTest, AShortEclipseDelaysNothing) {
  look(0.0, 40.0, 40.0);
  for (double t = 60.0; t <= 3600.0; t += 60.0) {
    safety_monitor_.take_sunlight(at(t), t < 600.0 || t > 1440.0);
    EXPECT_EQ(safety_monitor_.judge(at(t)).silence.is_alarm, t > 2100.0) << t;
  }
}

TEST_F(SafetyMonitorTest, AReceiverThatFailsInEclipseDelaysNothing) {
  look(0.0, 40.0, 40.0);
  safety_monitor_.take_sunlight(at(10.0), false);
  for (double t = 60.0; t <= 3600.0; t += 60.0)
    EXPECT_EQ(safety_monitor_.judge(at(t)).silence.is_alarm, t > 2100.0) << t;
}

// A target with its dark side towards the camera is not seen, but heard.
TEST_F(SafetyMonitorTest, ACodeBaselineEndsASilence) {
  look(0.0, 40.0, 40.0);
  safety_monitor_.take_code_baseline(at(2000.0), 41.0, 40.0);
  EXPECT_FALSE(safety_monitor_.judge(at(2101.0)).silence.is_alarm);
  safety_monitor_.take_code_baseline(at(1000.0), 41.0, 40.0);
  EXPECT_FALSE(safety_monitor_.judge(at(4100.0)).silence.is_alarm) << "an older one does not count";
  EXPECT_TRUE(safety_monitor_.judge(at(4101.0)).silence.is_alarm);
}

TEST_F(SafetyMonitorTest, ACodeBaselineContradictsNavigationUnlessItIsShort) {
  bool is_alarm = false;
  for (double t = 0.0; t <= 400.0; t += 10.0) {
    safety_monitor_.take_code_baseline(at(t), 40.0, 95.0);
    is_alarm = safety_monitor_.judge(at(t)).range.is_alarm;
    EXPECT_EQ(is_alarm, t >= SafetyMonitor::kLongestDisagreement_s) << t;
  }
  safety_monitor_ = SafetyMonitor();
  safety_monitor_.configure(kSettings);
  for (double t = 0.0; t <= 400.0; t += 10.0) {
    safety_monitor_.take_code_baseline(at(t), 9.0, 3.0);
    EXPECT_FALSE(safety_monitor_.judge(at(t)).range.is_checked) << "codes are wrong by metres";
  }
}

TEST_F(SafetyMonitorTest, SilenceFarAwayIsNone) {
  EXPECT_FALSE(safety_monitor_.judge(at(1e5)).silence.is_checked) << "there never was a range";
  look(0.0, 140.0, 140.0);
  EXPECT_FALSE(safety_monitor_.judge(at(9000.0)).silence.is_alarm);
}

TEST_F(SafetyMonitorTest, ABurnThatDiffersFromItsCommandIsAnAlarm) {
  safety_monitor_.take_command(4, {0.0, 1e-3, 0.0});
  safety_monitor_.take_report(4, {0.0, 0.9e-3, 0.0});
  EXPECT_FALSE(safety_monitor_.judge(at(0.0)).burns.is_alarm);
  safety_monitor_.take_command(5, {0.0, 1e-3, 0.0});
  safety_monitor_.take_report(5, {0.0, 0.7e-3, 0.0});
  EXPECT_TRUE(safety_monitor_.judge(at(1.0)).burns.is_alarm);
  safety_monitor_.take_report(99, {0.0, 1e-2, 0.0});
  EXPECT_TRUE(safety_monitor_.judge(at(2.0)).burns.is_alarm) << "nobody commanded it";
}

// 140 m at 0.3 m/s: the whole range in eight minutes.
TEST_F(SafetyMonitorTest, AFastApproachIsAnAlarm) {
  bool is_alarm = false;
  for (int k = 0; k < 500 && !is_alarm; ++k) {
    const double t = 5.0 * k;
    const double range_m = t < 1500.0 ? 140.0 : 140.0 - 0.3 * (t - 1500.0);
    if (range_m < 20.0) break;
    look(t, range_m, range_m);
    const Verdict closing = safety_monitor_.judge(at(t)).closing;
    if (t <= 1500.0) {
      EXPECT_FALSE(closing.is_alarm) << t;
    }
    is_alarm = closing.is_alarm;
  }
  EXPECT_TRUE(is_alarm);
}

}  // namespace

namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;
constexpr SafetyMonitorCamera kDarkLevelCamera{.focal_length_px = 6000.0, .dark_level_dn = 64.0, .noise_dn = 2.0};
constexpr double kSide = 0.7;  // m

/// A dark image with a bright rectangle.
std::vector<std::uint16_t> picture(int x0, int y0, int width, int height) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kWidth * kHeight), 70);
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) pixels[static_cast<std::size_t>(y * kWidth + x)] = 1500;
  }
  return pixels;
}
imaging::ImageView view(const std::vector<std::uint16_t>& pixels) {
  return {.frame = {.width = kWidth, .height = kHeight}, .pixels = pixels};
}

/// The Sun at a phase angle: 0 behind the camera.
Illumination at_phase(double angle) {
  return {.line_of_sight = Vector3::UnitZ(), .to_sun = Vector3(std::sin(angle), 0.0, -std::cos(angle))};
}

// A square face of 0.7 m in full light, 60 px wide: by similar triangles f * 0.7 / 60, of which
// nine tenths count as bright.
TEST(ApparentSize, RangeOfASquareByThePinhole) {
  const auto pixels = picture(100, 90, 60, 60);
  const LitArea area = lit_area(view(pixels), kDarkLevelCamera);
  EXPECT_EQ(area.pixels, 3600);
  EXPECT_FALSE(area.is_cut);
  const auto range_m = range_from_size(area, kDarkLevelCamera, at_phase(0.0), kSide);
  ASSERT_TRUE(range_m.has_value());
  EXPECT_NEAR(*range_m, 6000.0 * 0.9 * 0.7 / 60.0, 1e-9);
}

// Less of a sphere's disk is lit at a larger phase: the same lit area is then nearer.
TEST(ApparentSize, ThePhaseReducesTheLitArea) {
  const LitArea area{.pixels = 3600, .is_cut = false};
  const double full = *range_from_size(area, kDarkLevelCamera, at_phase(0.0), kSide);
  const double half = *range_from_size(area, kDarkLevelCamera, at_phase(1.0), kSide);
  EXPECT_NEAR(full / half, std::sqrt(2.0 / (1.0 + std::cos(1.0))), 1e-9);
}

TEST(ApparentSize, NothingFromACrescentACutTargetOrAFewPixels) {
  EXPECT_FALSE(range_from_size({3600, false}, kDarkLevelCamera, at_phase(2.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({3600, true}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({299, false}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({0, false}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  const double nan = std::nan("");
  EXPECT_FALSE(
      range_from_size({3600, false}, kDarkLevelCamera, {Vector3::Constant(nan), Vector3::UnitX()}, kSide).has_value());
}

TEST(ApparentSize, ATargetAtTheRimIsCut) {
  EXPECT_TRUE(lit_area(view(picture(kWidth - 60, 100, 60, 60)), kDarkLevelCamera).is_cut);
  EXPECT_TRUE(lit_area(view(picture(100, 0, 60, 60)), kDarkLevelCamera).is_cut);
  EXPECT_FALSE(lit_area(view(picture(1, 1, 60, 60)), kDarkLevelCamera).is_cut);
}

TEST(ApparentSize, DimmerLightShowsTheSameArea) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::uint16_t& pixel : pixels) pixel = pixel > 1000 ? 300 : pixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 3600);
  for (std::uint16_t& pixel : pixels) pixel = pixel > 200 ? 150 : pixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 0) << "hardly lit";
}

TEST(ApparentSize, AFewHotPixelsAreNotTheBrightestPart) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::size_t k = 0; k < 50; ++k) pixels[37 * k + 11] = 4095;
  const int lit = lit_area(view(pixels), kDarkLevelCamera).pixels;
  EXPECT_GE(lit, 3600);
  EXPECT_LE(lit, 3650);
}

TEST(ApparentSize, MissingPixelsAreNotLight) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::size_t k = 0; k < 5000; ++k) pixels[k] = imaging::kMissingPixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 3600);
}

}  // namespace

namespace {

TEST(RangeFilter, AConstantRangeIsKept) {
  RangeFilter filter;
  EXPECT_FALSE(filter.is_known());
  for (int k = 0; k < 500; ++k) filter.add(at(5.0 * k), 40.0);
  EXPECT_NEAR(filter.range_m(at(2500.0)), 40.0, 1e-9);
  EXPECT_NEAR(filter.range_rate(at(2500.0)), 0.0, 1e-12);
  EXPECT_TRUE(filter.has_rate());
}

// A range that shrinks by a constant share a second is a straight line of the logarithm: followed without a lag.
TEST(RangeFilter, FollowsASteadyApproach) {
  RangeFilter filter;
  const double rate = -3e-4;
  for (int k = 0; k <= 3000; ++k) filter.add(at(5.0 * k), 100.0 * std::exp(rate * 5.0 * k));
  const double range_m = 100.0 * std::exp(rate * 15000.0);
  EXPECT_NEAR(filter.range_m(at(15000.0)), range_m, 1e-3 * range_m);
  EXPECT_NEAR(filter.range_rate(at(15000.0)), rate * range_m, 0.01 * std::abs(rate * range_m));
}

// A tumbling target changes its size by a third in five minutes: a rate of 1e-3 a second if it were believed.
TEST(RangeFilter, AttitudesOfTheTargetAverageOut) {
  RangeFilter filter;
  accuracy::Largest largest;
  for (int k = 0; k < 4000; ++k) {
    const double t = 5.0 * k;
    filter.add(at(t), 10.0 * std::exp(0.15 * std::sin(2.0 * M_PI * t / 600.0)));
    if (filter.has_rate()) largest.add(std::abs(filter.range_rate(at(t))));
  }
  EXPECT_LT(largest, 10.0 / 2000.0);
}

TEST(RangeFilter, ALongGapBeginsAgain) {
  RangeFilter filter;
  for (int k = 0; k < 500; ++k) filter.add(at(5.0 * k), 40.0);
  filter.add(at(2495.0 + RangeFilter::kLongestGap_s + 1.0), 60.0);
  EXPECT_FALSE(filter.has_rate());
  EXPECT_NEAR(filter.range_m(filter.last()), 60.0, 1e-9);
}

TEST(RangeFilter, WhatIsNoRangeIsIgnored) {
  RangeFilter filter;
  filter.add(at(0.0), 40.0);
  filter.add(at(5.0), -1.0);
  filter.add(at(5.0), std::nan(""));
  filter.add(at(0.0), 80.0);
  EXPECT_EQ(filter.last(), at(0.0));
  EXPECT_NEAR(filter.range_m(at(0.0)), 40.0, 1e-9);
}

}  // namespace

}  // namespace vbar::fsw::fdir
