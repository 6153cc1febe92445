// Tables of light and the check of a calibration.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "hil_drivers/tron/calibration/procedure.h"
#include "tests/support/paths.h"

namespace vbar::tron::calibrate {
namespace {

/// A lamp of gamma 2.2, a box of gamma 1.8 that gives 90 % of what was designed.
std::vector<LightSample> samples() {
  std::vector<LightSample> result;
  for (int k = 1; k <= 8; ++k) {
    const double level = k / 8.0;
    result.push_back({"lamp", level, 5000.0 * 0.8 * std::pow(level, 2.2), 0.8});
    result.push_back({"box 3", level, 5000.0 * 0.9 * 0.06 * std::pow(level, 1.8), 0.06});
  }
  return result;
}

TEST(LightTables, AreRelativeToFullPowerAsDesigned) {
  const auto tables = light_tables(samples());
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].source, "lamp");
  EXPECT_NEAR(tables[0].light.back(), 1.0, 1e-12);
  EXPECT_NEAR(tables[1].light.back(), 0.9, 1e-12);
  EXPECT_NEAR(tables[1].light[3], 0.9 * std::pow(0.5, 1.8), 1e-12);
  EXPECT_NEAR(lamp_dn_per_s(samples()), 5000.0, 1e-9);
  // As the driver takes them.
  const LightResponse response(tables[1]);
  EXPECT_NEAR(response.level(0.9 * std::pow(0.3, 1.8)), 0.3, 1e-9);
}

TEST(LightTables, LeaveOutLevelsThatDoNotRise) {
  auto noisy = samples();
  noisy[0].dn_per_s = -3.0;
  noisy[4].dn_per_s = noisy[2].dn_per_s;
  const auto tables = light_tables(noisy);
  EXPECT_EQ(tables[0].level.size(), 6U);
  EXPECT_TRUE(light_tables({}).empty());
}

/// Levels of a bench whose patch is a uniform white image.
class WhiteBench final : public CalibrationTestbed {
 public:
  TestbedIdentity identity() override { return {"model", "serial", true}; }
  void mount(Mounted) override {}
  bool move(const Posture&) override { return ++moves_ > blocked; }
  MeasuredPosture measure() override { return {}; }
  void light(const LightShares& shares) override { shares_ = shares; }
  CalibrationImage take(double exposure_s) override {
    const double light = 1e6 * std::pow(shares_.lamp, 2.2) + 1e5 * std::pow(shares_.boxes[4], 1.5);
    CalibrationImage image{1600, 1000, 12, std::vector<std::uint16_t>(1600 * 1000)};
    for (std::size_t k = 0; k < image.dn.size(); ++k)
      image.dn[k] = static_cast<std::uint16_t>(
          std::min(4095.0, 64.0 + static_cast<double>((k * 2654435761U) % 5U) + light * exposure_s));
    return image;
  }

  int blocked = 0;  ///< of the first moves

 private:
  int moves_ = 0;
  LightShares shares_;
};

TEST(Photometry, MeasuresTheCurvesOfTheSources) {
  WhiteBench bench;
  const TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  const LensCalibration lens{1600, 1000, 2901.0, 2901.0, 799.5, 499.5, {}};
  const auto postures = choose_patch_postures(file, lens, BoardDesign{}, 1.5, 3);
  std::vector<PatchPosture> two;
  for (PatchPosture posture : postures) {
    std::erase_if(posture.lights, [](const auto& light) { return light.source != 0 && light.source != 5; });
    if (!posture.lights.empty()) two.push_back(posture);
  }
  const auto measured = measure_lights(bench, lens, file, BoardDesign{}, two, 1.5, 8);
  ASSERT_EQ(measured.size(), 16U);
  for (const LightSample& sample : measured) {
    const bool is_lamp = sample.source == "lamp";
    const double expected = is_lamp ? 1e6 * std::pow(sample.level, 2.2) : 1e5 * std::pow(sample.level, 1.5);
    // Rounding to whole DN at some 2,000.
    EXPECT_NEAR(sample.dn_per_s, expected, (is_lamp ? 1e6 : 1e5) * 1e-3) << sample.source << sample.level;
  }
}

TEST(Photometry, SourcesThatWereNotReachedGetOtherPostures) {
  WhiteBench bench;
  bench.blocked = 1;
  const TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  const LensCalibration lens{1600, 1000, 2901.0, 2901.0, 799.5, 499.5, {}};
  auto postures = choose_patch_postures(file, lens, BoardDesign{}, 1.5, 3);
  for (PatchPosture& posture : postures)
    std::erase_if(posture.lights, [](const auto& light) { return light.source != 0 && light.source != 5; });
  std::erase_if(postures, [](const PatchPosture& posture) { return posture.lights.empty(); });
  ASSERT_GE(postures.size(), 2U);
  const std::size_t blocked = postures.front().lights.front().source;
  const auto measured = measured_sources(measure_lights(bench, lens, file, BoardDesign{}, postures, 1.5, 2));
  EXPECT_FALSE(measured.at(blocked));
  EXPECT_EQ(std::ranges::count(measured, true), 1);
  const auto others = choose_patch_postures(file, lens, BoardDesign{}, 1.5, 4, {}, measured);
  int of_blocked = 0;
  for (const PatchPosture& posture : others)
    for (const auto& light : posture.lights) {
      of_blocked += light.source == blocked ? 1 : 0;
      EXPECT_FALSE(measured.at(light.source)) << "measured twice";
    }
  EXPECT_EQ(of_blocked, 1);
}

TEST(Photometry, MeasuresTheCameraWithoutLight) {
  WhiteBench bench;
  const DarkFigures dark = measure_dark(bench, 1e-3);
  EXPECT_NEAR(dark.offset_dn, 66.0, 0.01);  // mean of 64 to 68
  EXPECT_EQ(dark.read_noise_dn, 0.0);       // the pattern is fixed
}

TEST(CalibrationCheck, WithoutMeasurementsIsNotPassed) {
  const TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  Calibration calibration = calibration_as_designed(file);
  calibration.covariance.arms = calibration.covariance.vicon = 1e-6 * Matrix6::Identity();
  const CheckResult result = judge(calibration, file, {});
  EXPECT_FALSE(result.is_valid);
  EXPECT_NE(result.reason.find("0 postures"), std::string::npos) << result.reason;
}

}  // namespace
}  // namespace vbar::tron::calibrate
