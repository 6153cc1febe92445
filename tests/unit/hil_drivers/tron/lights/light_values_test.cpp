// Values of 16 bits from powers of light.

#include "hil_drivers/tron/lights/light_values.h"

#include <cmath>

#include <gtest/gtest.h>

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
}  // namespace vbar::tron
