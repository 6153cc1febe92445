// Values of 16 bits from powers of light.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/tron/lights/photometry.h"
#include "hil_drivers/tron/lights/room_light.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

Lamp lamp() {
  Lamp lamp;
  lamp.azimuth_low_rad = 1.0;
  lamp.azimuth_high_rad = 2.0;
  return lamp;
}

TEST(LightValues, AreSharesOf65535) {
  LightLevels levels;
  levels.lamp_power = 0.5;
  levels.lamp_azimuth_rad = 1.25;
  levels.box_power = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0};
  const LightValues values = light_values(levels, lamp(), {});
  const LightValues expected{32768, 16384, 0, 6554, 13107, 19661, 26214, 32768, 39321, 45875, 52428, 65535};
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(values[k], expected[k], 1) << k;
}

// 65535 w^(1/g).
TEST(LightValues, UndoTheGammaOfTheTable) {
  std::vector<LightTable> tables;
  for (std::size_t k = 0; k < kLightSources; ++k)
    tables.push_back({light_source_name(k), {0.5, 1.0}, {std::pow(0.5, 2.0 + 0.1 * static_cast<double>(k)), 1.0}});
  LightLevels levels;
  levels.lamp_power = 0.3;
  levels.box_power.fill(0.2);
  const LightValues values = light_values(levels, lamp(), PhotometricTable(tables));
  EXPECT_EQ(values[0], std::lround(65535 * std::pow(0.3, 1 / 2.0)));
  for (std::size_t k = 1; k <= kBoxes; ++k)
    EXPECT_EQ(values[1 + k], std::lround(65535 * std::pow(0.2, 1 / (2.0 + 0.1 * static_cast<double>(k)))));
}

TEST(LightValues, AreCutToWhatTheLightsCanDo) {
  LightLevels levels;
  levels.lamp_power = 1.5;
  levels.lamp_azimuth_rad = 7.0;
  levels.box_power.fill(-0.1);
  levels.box_power[3] = std::nan("");
  const LightValues values = light_values(levels, lamp(), {});
  EXPECT_EQ(values[0], 65535);
  EXPECT_EQ(values[1], 65535);
  for (std::size_t k = 2; k < values.size(); ++k) EXPECT_EQ(values[k], 0);
  levels.lamp_azimuth_rad = -7.0;
  EXPECT_EQ(light_values(levels, lamp(), {})[1], 0);
  Lamp fixed = lamp();
  fixed.azimuth_high_rad = fixed.azimuth_low_rad;
  EXPECT_EQ(light_values(levels, fixed, {})[1], 0);
}

}  // namespace

// Photometric tables: power laws exactly, other curves between their points, and tables that are refused.

namespace {

using ::testing::HasSubstr;

const std::vector<double> kLevels{0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0};

LightTable table(const std::string& source, double (*light)(double)) {
  LightTable table{source, kLevels, {}};
  for (const double level : kLevels) table.light.push_back(light(level));
  return table;
}

std::string refusal_of(const LightTable& bad) {
  try {
    (void)LightResponse(bad);
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(LightResponse, IsAsDesignedWithoutATable) {
  const LightResponse response;
  for (const double level : {0.0, 1e-6, 0.3, 1.0}) {
    EXPECT_NEAR(response.light(level), level, 1e-15);
    EXPECT_NEAR(response.level(level), level, 1e-15);
  }
}

TEST(LightResponse, MeetsAPowerLawExactlyBelowItsLowestLevelToo) {
  const LightResponse response(table("lamp", [](double level) { return 0.97 * std::pow(level, 2.2); }));
  EXPECT_NEAR(response.full_light(), 0.97, 1e-14);
  for (const double level : {1e-4, 0.01, 0.07, 0.33, 0.99, 1.0}) {
    EXPECT_NEAR(response.light(level), 0.97 * std::pow(level, 2.2), 1e-13);
    EXPECT_NEAR(response.level(0.97 * std::pow(level, 2.2)), level, 1e-13);
  }
  EXPECT_EQ(response.level(0.98), 1.0);  // more than it can give
  EXPECT_EQ(response.level(0.0), 0.0);
  EXPECT_EQ(response.level(-0.1), 0.0);
  EXPECT_EQ(response.light(0.0), 0.0);
}

TEST(LightResponse, RisesAndIsInvertedBetweenAnyPoints) {
  const LightResponse response(table("lamp", [](double level) { return 0.1 * level + 0.9 * std::pow(level, 3); }));
  double before = 0.0;
  for (double level = 0.001; level <= 1.0; level += 0.001) {
    const double light = response.light(level);
    EXPECT_GT(light, before);
    EXPECT_NEAR(response.level(light), level, 1e-12);
    before = light;
  }
}

TEST(LightResponse, LeavesLevelsOfZeroOut) {
  const LightResponse response(LightTable{"lamp", {0.0, 0.5, 1.0}, {-1e-4, 0.25, 1.0}});
  EXPECT_NEAR(response.light(0.1), 0.01, 1e-14);
}

TEST(LightResponse, NamesTheSourceOfATableThatIsRefused) {
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.3, 0.3}}), HasSubstr("'box 3': the light does not rise"));
  EXPECT_THAT(refusal_of({"box 3", {1.0, 0.5}, {0.2, 0.3}}), HasSubstr("'box 3': the levels do not rise"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.1}, {0.2, 0.3}}), HasSubstr("not in 0 to 1"));
  EXPECT_THAT(refusal_of({"box 3", {std::nan(""), 1.0}, {0.2, 0.3}}), HasSubstr("not in 0 to 1"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {std::nan(""), 0.3}}), HasSubstr("not positive"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.0, 0.3}}), HasSubstr("not positive"));
  EXPECT_THAT(refusal_of({"box 3", {0.5, 1.0}, {0.3}}), HasSubstr("differ in number"));
  EXPECT_THAT(refusal_of({"box 3", {0.0, 1.0}, {0.0, 1.0}}), HasSubstr("fewer than two"));
}

TEST(PhotometricTable, HasEverySourceOnce) {
  std::vector<LightTable> tables;
  for (std::size_t k = 0; k < kLightSources; ++k)
    tables.push_back(table(light_source_name(k), [](double level) { return level * level; }));
  EXPECT_NEAR(PhotometricTable(tables).box(9).light(0.5), 0.25, 1e-14);
  EXPECT_NEAR(PhotometricTable(tables).lamp().light(0.5), 0.25, 1e-14);
  auto missing = tables;
  missing.erase(missing.begin() + 4);
  auto twice = tables;
  twice.push_back(tables[2]);
  auto unknown = tables;
  unknown[0].source = "moon";
  EXPECT_THROW(PhotometricTable{missing}, std::invalid_argument);
  EXPECT_THROW(PhotometricTable{twice}, std::invalid_argument);
  EXPECT_THROW(PhotometricTable{unknown}, std::invalid_argument);
}

}  // namespace

// Light of an image: where the Earth is as the target sees it.

namespace {

using fsw::Vector3;

class RoomLightTest : public ::testing::Test {
 protected:
  RoomLightTest() {
    place_.posture.target_rad << 0.1, -1.2, 1.3, 0.2, 0.4, 0.3;
    place_.lamp_azimuth_rad = 1.7;
    T_L_T_ = T_L_T_of_arm(calibration_, place_.posture);
    scene_.sunlit = 0.7;
    scene_.earth_to_sun = 0.2;
    scene_.T_C_T.linear() = Eigen::AngleAxisd(2.0, Vector3(1, 2, 3).normalized()).toRotationMatrix();
    scene_.T_C_T.translation() = Vector3(0, 0, 3);
  }
  /// The Earth in this direction of the laboratory.
  void put_earth(const Vector3& direction_L) {
    scene_.earth_C = scene_.T_C_T.linear() * T_L_T_.linear().transpose() * direction_L.normalized();
  }

  TestbedDesign bench_ = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  Calibration calibration_ = calibration_as_designed(bench_);
  Scene scene_;
  Place place_;
  Eigen::Isometry3d T_L_T_;
};

TEST_F(RoomLightTest, ShinesFromTheSideOnWhichTheTargetSeesTheEarth) {
  RoomLight light(bench_, calibration_, {});
  const Vector3 middle = T_L_T_ * (0.25 * (bench_.target.body_low_m + bench_.target.body_high_m));
  for (const double side : {-1.0, 1.0}) {
    put_earth(Vector3(0, side, 0));
    const LightLevels levels = light.levels(scene_, place_);
    double here = 0, there = 0;
    for (std::size_t k = 0; k < kBoxes; ++k) {
      const double y = bench_.boxes.boxes[k].centre_m.y();
      if (std::abs(y) > 1.0) (y * side > 0.0 ? here : there) += levels.box_power[k];  // of the side walls
    }
    EXPECT_GT(here, 5.0 * there) << side;
    const BoxPowers expected = BoxLight(bench_).powers(middle, {Vector3(0, side, 0), scene_.earth_half_angle, 0.2});
    for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(levels.box_power[k], expected.power[k], 1e-9);
    ASSERT_TRUE(levels.earth_misfit);
    EXPECT_NEAR(*levels.earth_misfit, expected.misfit, 1e-9);
  }
}

TEST_F(RoomLightTest, TheLampIsTheVisiblePartOfTheSun) {
  RoomLight light(bench_, calibration_, {});
  const LightLevels levels = light.levels(scene_, place_);
  EXPECT_EQ(levels.lamp_power, 0.7);
  EXPECT_EQ(levels.lamp_azimuth_rad, 1.7);
  EXPECT_NEAR(exposure_factor(bench_.lamp), 10.0, 1e-12);  // irradiance 0.1 of the Sun's
}

TEST_F(RoomLightTest, WithoutEarthLightTheBoxesAreOff) {
  RoomLight light(bench_, calibration_, {});
  scene_.earth_to_sun = 0.0;
  const LightLevels levels = light.levels(scene_, place_);
  for (const double power : levels.box_power) EXPECT_EQ(power, 0.0);
  EXPECT_FALSE(levels.earth_misfit);
}

}  // namespace

}  // namespace vbar::tron
