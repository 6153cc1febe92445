// Lamp and boxes: response, arc, faults.

#include "hil_drivers/tron/bench/lights/light_rig.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace vbar::tron::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Lamp lamp() {
  Lamp lamp;
  lamp.azimuth_low_rad = 45.0 * kDegree;
  lamp.azimuth_high_rad = 135.0 * kDegree;
  lamp.speed_rad_s = 10.0 * kDegree;
  return lamp;
}

LightValues values(std::uint16_t power, std::uint16_t place, std::uint16_t box = 0) {
  LightValues values;
  values.fill(box);
  values[0] = power;
  values[1] = place;
  return values;
}

TEST(LightRig, WithoutErrorsGivesLightInProportion) {
  LightRig rig(lamp(), LightErrorSizes::none(), 1);
  rig.command(values(65535, 0, 13107));
  EXPECT_DOUBLE_EQ(rig.lights().lamp_power, 1.0);
  for (const double power : rig.lights().box_power) EXPECT_NEAR(power, 0.2, 1e-12);
  rig.switch_off();
  EXPECT_EQ(rig.lights().lamp_power, 0.0);
  EXPECT_EQ(rig.lights().box_power[9], 0.0);
}

// From the middle, 90 deg, at 10 deg/s: 2 s to 110 deg, which 16 bits resolve to 0.0014 deg.
TEST(LightRig, TheLampTravelsAlongItsArc) {
  LightRig rig(lamp(), {}, 1);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 90.0 * kDegree, 1e-12);
  rig.advance(5.0);
  rig.command(values(0, static_cast<std::uint16_t>(std::lround(65535.0 * (110.0 - 45.0) / 90.0))));
  rig.advance(6.0);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 100.0 * kDegree, 1e-9);
  rig.advance(6.0);
  rig.advance(5.5);  // time does not run backwards
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 100.0 * kDegree, 1e-9);
  rig.advance(7.1);
  EXPECT_NEAR(rig.lights().lamp_azimuth_rad, 110.0 * kDegree, 0.0007 * kDegree);
  rig.command(values(0, 0));
  rig.advance(8.0);
  rig.switch_off();  // the lamp stays where it is
  const double here = rig.lights().lamp_azimuth_rad;
  rig.advance(20.0);
  EXPECT_EQ(rig.lights().lamp_azimuth_rad, here);
}

// A power law: the logarithm of light is linear in that of the value, with the gain at the full value.
TEST(LightRig, SourcesHaveTheirOwnGammaAndGain) {
  double gamma = 0, gamma2 = 0, gain = 0, gain2 = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    LightRig rig(lamp(), {}, seed);
    rig.command(values(65535, 0, 65535));
    const TrueLights full = rig.lights();
    rig.command(values(6554, 0, 6554));
    const TrueLights tenth = rig.lights();
    const auto add = [&](double light, double light_of_tenth) {
      const double g = std::log(light_of_tenth / light) / std::log(6554.0 / 65535.0);
      gamma += g;
      gamma2 += g * g;
      gain += light;
      gain2 += light * light;
      ++count;
    };
    add(full.lamp_power, tenth.lamp_power);
    for (std::size_t k = 0; k < kBoxes; ++k) add(full.box_power[k], tenth.box_power[k]);
  }
  // Of 550 sources: the mean to 1/23 of a deviation, the deviation to 3 %.
  gamma /= count;
  gain /= count;
  EXPECT_NEAR(gamma, 2.2, 0.03);
  EXPECT_NEAR(std::sqrt(gamma2 / count - gamma * gamma), 0.15, 0.02);
  EXPECT_NEAR(gain, 1.0, 0.006);
  EXPECT_NEAR(std::sqrt(gain2 / count - gain * gain), 0.03, 0.004);
}

TEST(LightRig, FaultsHoldUntilTheyAreTakenBack) {
  LightRig rig(lamp(), {}, 1);
  rig.command(values(65535, 0, 65535));
  const TrueLights all = rig.lights();
  rig.set_box_out(3, true);
  rig.set_lamp_out(true);
  EXPECT_EQ(rig.lights().lamp_power, 0.0);
  EXPECT_EQ(rig.lights().box_power[3], 0.0);
  EXPECT_EQ(rig.lights().box_power[4], all.box_power[4]);
  rig.set_box_out(3, false);
  rig.set_lamp_out(false);
  EXPECT_EQ(rig.lights().lamp_power, all.lamp_power);
  EXPECT_EQ(rig.lights().box_power, all.box_power);
  EXPECT_ANY_THROW(rig.set_box_out(10, true));
}

TEST(LightRig, IsAFunctionOfTheSeed) {
  LightRig one(lamp(), {}, 8), same(lamp(), {}, 8), other(lamp(), {}, 9);
  for (LightRig* rig : {&one, &same, &other}) rig->command(values(30000, 0, 30000));
  EXPECT_EQ(one.lights().box_power, same.lights().box_power);
  EXPECT_NE(one.lights().box_power, other.lights().box_power);
}

}  // namespace
}  // namespace vbar::tron::bench
