// The Earth as seen from orbit, against plane geometry and the light of a Lambert sphere.

#include "host_sim/twins/camera/earth_disc.h"

#include <cmath>

#include <gtest/gtest.h>

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

constexpr double kRadius = 6378137.0, kPolarRadius = 6356752.314245;
const Vector3 kSun(1.5e11, 0.0, 0.0);

// In the plane of the equator the Earth is a circle.
TEST(EarthDisc, its_limb_is_at_the_horizon) {
  const camera::EarthDisc earth(Vector3(7.0e6, 0.0, 0.0), kSun);
  const double horizon = std::asin(kRadius / 7.0e6);
  EXPECT_NEAR(earth.angular_radius(), horizon, 1e-12);
  const auto covered = [&](double off) {
    return earth.look(Vector3(-std::cos(horizon + off), std::sin(horizon + off), 0.0), 1e-4).covered;
  };
  EXPECT_EQ(covered(-1e-4), 1.0);
  EXPECT_NEAR(covered(0.0), 0.5, 1e-3);
  EXPECT_NEAR(covered(2e-5), 0.3, 1e-3);
  EXPECT_EQ(covered(1e-4), 0.0);
}

TEST(EarthDisc, the_poles_are_flattened) {
  // From above the equator, looking at a pole: the tangent to the ellipse x^2/a^2 + z^2/b^2 = 1 from (r, 0) has the
  // slope b / sqrt(r^2 - a^2).
  const camera::EarthDisc earth(Vector3(7.0e6, 0.0, 0.0), kSun);
  const double limb = std::atan(kPolarRadius / std::sqrt(49e12 - kRadius * kRadius));
  EXPECT_NEAR(earth.look(Vector3(-std::cos(limb), 0.0, std::sin(limb)), 1e-4).covered, 0.5, 1e-3);
}

TEST(EarthDisc, distances_and_the_sun_s_height_straight_down) {
  const camera::EarthDisc above_equator(Vector3(7.0e6, 0.0, 0.0), kSun);
  const camera::EarthSight down = above_equator.look(-Vector3::UnitX(), 1e-4);
  EXPECT_NEAR(down.distance_m, 7.0e6 - kRadius, 1e-3);
  EXPECT_NEAR(down.cosine_of_sun, 1.0, 1e-12);
  EXPECT_EQ(above_equator.look(Vector3::UnitX(), 1e-4).covered, 0.0);

  const camera::EarthDisc above_pole(Vector3(0.0, 0.0, 7.0e6), kSun);
  const camera::EarthSight pole = above_pole.look(-Vector3::UnitZ(), 1e-4);
  EXPECT_NEAR(pole.distance_m, 7.0e6 - kPolarRadius, 1e-3);
  EXPECT_NEAR(pole.cosine_of_sun, 0.0, 1e-12);

  const camera::EarthDisc at_night(Vector3(-7.0e6, 0.0, 0.0), kSun);
  EXPECT_LT(at_night.look(Vector3::UnitX(), 1e-4).cosine_of_sun, -0.999);
}

TEST(EarthDisc, hides_what_is_behind_it_and_nothing_before_it) {
  const camera::EarthDisc earth(Vector3(7.0e6, 0.0, 0.0), kSun);
  EXPECT_TRUE(earth.hides(-Vector3::UnitX(), 1e7));
  EXPECT_FALSE(earth.hides(-Vector3::UnitX(), 1e5));
  EXPECT_FALSE(earth.hides(Vector3::UnitY(), 1e9));
}

// Far away the Earth is a Lambert sphere: (2/3) albedo (R/d)^2 (sin a + (pi - a) cos a)/pi of the sunlight; its
// flattening changes the disc by 0.3 per cent, the rule of 1152 points the sum by another.
TEST(EarthDisc, its_light_is_that_of_a_lambert_sphere) {
  for (const double phase : {0.0, 1.0, 2.0}) {
    const camera::EarthDisc earth(3e9 * Vector3(std::cos(phase), std::sin(phase), 0.0), kSun);
    const double expected =
        2.0 / 3.0 * 0.3 * std::pow(kRadius / 3e9, 2) * (std::sin(phase) + (M_PI - phase) * std::cos(phase)) / M_PI;
    EXPECT_NEAR(earth.light_eci(1.0).norm() / expected, 1.0, 0.01) << phase;
  }
}

// Low above the subsolar point: radiance times the projected solid angle, 0.3 (R/r)^2 were all of the visible cap lit
// upright; the Sun stands up to 24 deg lower at its rim.
TEST(EarthDisc, its_light_low_above_the_subsolar_point) {
  const Vector3 light = camera::EarthDisc(Vector3(7.0e6, 0.0, 0.0), kSun).light_eci(1.0);
  const double most = 0.3 * std::pow(kRadius / 7.0e6, 2);
  EXPECT_NEAR(-light.normalized().x(), 1.0, 1e-6);
  EXPECT_LT(light.norm(), most);
  EXPECT_GT(light.norm(), std::cos(0.43) * most);
}

}  // namespace
