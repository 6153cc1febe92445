// Sun and Moon as points of light: what they sum to, how wide they are, which side is lit.

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/earth_disc.h"
#include "host_sim/twins/camera/sun_moon_discs.h"
#include "tests/support/figures.h"

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

double sum(const std::vector<camera::LightSample>& samples) {
  double photons = 0.0;
  for (const auto& sample : samples) photons += sample.photons_per_m2_s;
  return photons;
}

TEST(Discs, a_uniform_disc_has_its_flux_radius_and_centre) {
  const Vector3 direction = Vector3(0.3, -0.4, 1.0).normalized();
  std::vector<camera::LightSample> samples;
  camera::uniform_disc(direction, 0.00465, 7.0, 60, samples);
  EXPECT_NEAR(sum(samples), 7.0, 1e-12);
  vbar::accuracy::Largest widest;
  double square = 0.0;
  Vector3 middle = Vector3::Zero();
  for (const auto& sample : samples) {
    const double angle = sample.direction_camera.cross(direction).norm();
    widest.add(angle);
    square += sample.photons_per_m2_s * angle * angle / 7.0;
    middle += sample.photons_per_m2_s * sample.direction_camera;
  }
  EXPECT_NEAR(widest, 0.00465, 0.0001);
  EXPECT_NEAR(std::sqrt(2.0 * square), 0.00465, 0.00005);  // of an even disc the mean square is half the radius'
  EXPECT_NEAR(middle.normalized().cross(direction).norm(), 0.0, 1e-9);
}

// Allen: full Moon -12.73, first quarter -10.0 (a = 90: 0.026 * 90 + 4e-9 * 90^4 = 2.60).
TEST(Discs, the_moon_s_magnitude_follows_its_phase) {
  EXPECT_NEAR(camera::moon_magnitude(0.0, 3.844e8), -12.73, 1e-9);
  EXPECT_NEAR(camera::moon_magnitude(M_PI / 2.0, 3.844e8), -10.13, 0.01);
  EXPECT_NEAR(camera::moon_magnitude(0.0, 7.688e8), -12.73 + 1.505, 0.001);
}

TEST(Discs, half_a_moon_is_lit_on_the_sun_s_side) {
  const Vector3 moon(0.0, 0.0, 3.844e8);
  std::vector<camera::LightSample> samples;
  camera::moon_disc(moon, Vector3::UnitX(), 1.0, 80, samples);
  ASSERT_FALSE(samples.empty());
  for (const auto& sample : samples) {
    ASSERT_GT(sample.direction_camera.x(), 0.0);
    ASSERT_LT(sample.direction_camera.head<2>().norm(), 1.7374e6 / 3.844e8 * 1.001);
  }
  // -10.13, and a colour factor between 1 and 1.1.
  EXPECT_NEAR(sum(samples) / std::pow(10.0, 0.4 * 10.13), 1.05, 0.06);
}

TEST(Discs, the_full_moon_is_flat_and_the_new_moon_dark) {
  const Vector3 moon(0.0, 0.0, 3.844e8);
  std::vector<camera::LightSample> samples;
  camera::moon_disc(moon, -Vector3::UnitZ(), 1.0, 40, samples);
  vbar::accuracy::Smallest least;
  vbar::accuracy::Largest most;
  for (const auto& sample : samples) {
    least.add(sample.photons_per_m2_s);
    most.add(sample.photons_per_m2_s);
  }
  EXPECT_NEAR(least / most, 1.0, 0.05);
  samples.clear();
  camera::moon_disc(moon, Vector3::UnitZ(), 1.0, 40, samples);
  EXPECT_LT(sum(samples), 1e-4 * std::pow(10.0, 0.4 * 12.73));
}

}  // namespace

// The Earth as seen from orbit, against plane geometry and the light of a Lambert sphere.

namespace {

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
