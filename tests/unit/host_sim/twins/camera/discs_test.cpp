// Sun and Moon as points of light: what they sum to, how wide they are, which side is lit.

#include "host_sim/twins/camera/discs.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

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
