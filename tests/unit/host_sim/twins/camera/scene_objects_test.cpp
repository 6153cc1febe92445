// Spacecraft in the image: their light, their place, and that nothing jumps between a point and a disc.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/twins/camera/lambert_sphere.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/camera_picture.h"
#include "tests/support/camera_scene.h"
#include "tests/support/paths.h"

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::Vector3;
using vbar::test::Blob;
using vbar::test::measure;
using vbar::test::object_at;
using vbar::test::quiet_exposure;
namespace camera = vbar::twins::camera;

const Vector2 kMiddle(959.5, 599.5);
constexpr double kFocalPx = 35.0 / 5.86e-3;
constexpr double kRadius = 0.35, kAlbedo = 0.3;

camera::SceneRenderer& renderer() {
  static camera::SceneRenderer made(camera::CameraSettings{}, vbar::test::camera_data(),
                                    camera::lambert_sphere(kRadius, kAlbedo));
  return made;
}

/// The light of the objects alone: the image less that of the same sky without them.
camera::PhotonImage objects_of(const camera::Exposure& exposure) {
  camera::PhotonImage with, without;
  renderer().render(exposure, with);
  camera::Exposure empty = exposure;
  empty.objects.clear();
  renderer().render(empty, without);
  return vbar::test::difference(with, without);
}

Vector2 pinhole(const Vector3& position_camera) {
  return kMiddle + kFocalPx * position_camera.head<2>() / position_camera.z();
}

/// The Sun at `phase` (rad) from the camera, as seen from the object ahead: 0 is straight behind the camera.
camera::Exposure lit_at(double phase) {
  camera::Exposure exposure = quiet_exposure(Vector3(0.2, 1.0, 0.1));
  exposure.sun_eci =
      vbar::test::kSunDistance * (exposure.q_camera_eci.conjugate() * Vector3(0.0, -std::sin(phase), -std::cos(phase)));
  return exposure;
}

// Sunlight at 1.5e11 m by hand: 3.1e10 * 10^(0.4 * 26.74) * 1.01 (colour) * (1.496/1.5)^2 = 1.546e21 photons/(m^2 s);
// a Lambert sphere sends back (2/3) albedo (R/d)^2 (sin a + (pi - a) cos a)/pi of it; 3.358e-5 electrons a photon/m^2.
TEST(SceneObjects, a_sphere_s_light_at_three_ranges_and_phases) {
  for (const double range : {300.0, 5e3, 75e3})
    for (const double phase : {0.0, 1.0, 2.0}) {
      camera::Exposure exposure = lit_at(phase);
      exposure.objects.push_back(object_at(exposure, Vector3(0.001, -0.0007, 1.0) * range));
      const double expected = 1.546e21 * 2.0 / 3.0 * kAlbedo * std::pow(kRadius / range, 2) *
                              (std::sin(phase) + (M_PI - phase) * std::cos(phase)) / M_PI * 3.358e-5;
      const Blob blob = measure(objects_of(exposure), kMiddle + Vector2(6.0, -4.0), 60.0);
      EXPECT_NEAR(blob.electrons / expected, 1.0, 0.02) << range << " m, phase " << phase;
    }
}

// The project allows 0.02 px. Far away the sphere is a point; fully lit, its centroid is its centre.
TEST(SceneObjects, a_point_s_centroid_is_where_it_is_projected) {
  for (double u = 0.0; u < 1.0; u += 0.11) {
    const Vector3 position = 75e3 * Vector3((10.0 + u) / kFocalPx, (-7.0 - 0.6 * u) / kFocalPx, 1.0);
    for (const double rate : {0.0, 1.06e-3}) {
      camera::Exposure exposure = lit_at(0.0);
      exposure.rate_camera = Vector3(rate, 0.0, 0.0);
      exposure.objects.push_back(object_at(exposure, position));
      const Blob blob = measure(objects_of(exposure), pinhole(position), 30.0);
      EXPECT_NEAR((blob.centroid - pinhole(position)).norm(), 0.0, 0.005);
      // It flies with the camera, so it is not drawn out while the stars are.
      EXPECT_NEAR(blob.spread(1, 1), blob.spread(0, 0), 0.01 * blob.spread(0, 0));
    }
  }
}

TEST(SceneObjects, an_object_that_crosses_is_drawn_out) {
  camera::Exposure exposure = lit_at(0.0);
  exposure.objects.push_back(object_at(exposure, Vector3(0.0, 0.0, 10e3)));
  const Blob still = measure(objects_of(exposure), kMiddle, 30.0);
  exposure.objects[0].velocity_eci = exposure.q_camera_eci.conjugate() * Vector3(20.0, 0.0, 5.0);
  const Blob moving = measure(objects_of(exposure), kMiddle, 30.0);
  const double length = 20.0 * 0.2 / 10e3 * kFocalPx;  // 2.39 px
  EXPECT_NEAR(moving.spread(0, 0) - still.spread(0, 0), length * length / 12.0, 0.02);
  EXPECT_NEAR(moving.spread(1, 1) - still.spread(1, 1), 0.0, 0.005);
  EXPECT_NEAR((moving.centroid - still.centroid).norm(), 0.0, 0.002);
}

// From 10 km to 100 m in steps of 4 per cent the same code draws 0.4 px and 42 px: flux times range^2 and the
// centroid's place against the disc's (in radii of the disc) may change only as they should, slowly.
TEST(SceneObjects, nothing_jumps_between_point_and_disc) {
  // Light's centre of a Lambert sphere at phase 1: numerically (disc integral of the cosine), in radii.
  double moment = 0.0, sum = 0.0;
  constexpr int kCells = 400;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const double x = (2.0 * i + 1.0) / kCells - 1.0, y = (2.0 * j + 1.0) / kCells - 1.0;
      if (x * x + y * y >= 1.0) continue;
      const double cosine = std::max(0.0, -std::sin(1.0) * y + std::cos(1.0) * std::sqrt(1.0 - x * x - y * y));
      sum += cosine;
      moment += cosine * y;
    }
  double before_flux = 0.0;
  for (double range = 10e3; range > 100.0; range *= 0.96) {
    camera::Exposure exposure = lit_at(1.0);
    const Vector3 position = Vector3(0.0102, 0.0043, 1.0) * range;
    exposure.objects.push_back(object_at(exposure, position));
    const Blob blob = measure(objects_of(exposure), pinhole(position), 70.0);
    const double flux = blob.electrons * range * range;
    if (before_flux > 0.0) {
      EXPECT_NEAR(flux / before_flux, 1.0, 5e-4) << range;
    }
    before_flux = flux;
    const double radius_px = kRadius / range * kFocalPx;
    const Vector2 expected = pinhole(position) + Vector2(0.0, radius_px * moment / sum);
    EXPECT_NEAR((blob.centroid - expected).norm(), 0.0, 0.003 + 0.01 * radius_px) << range;
  }
}

TEST(SceneObjects, out_of_the_field_or_behind_the_camera_nothing_is_drawn) {
  for (const Vector3& position :
       {Vector3(0.0, 20e3, 75e3), Vector3(0.0, 0.0, -75e3), Vector3(75e3, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)}) {
    camera::Exposure exposure = lit_at(0.5);
    exposure.objects.push_back(object_at(exposure, position));
    for (const float light : objects_of(exposure).electrons) ASSERT_EQ(light, 0.0F);
  }
}

TEST(SceneObjects, on_the_region_s_edge_half_of_it_is_drawn) {
  camera::Exposure exposure = lit_at(0.0);
  const Vector3 position = 50e3 * Vector3((709.5 - 959.5) / kFocalPx, 0.0, 1.0);
  exposure.objects.push_back(object_at(exposure, position));
  const double half = measure(objects_of(exposure), Vector2(710.0, 599.5), 40.0).electrons;
  exposure.objects[0] = object_at(exposure, position + Vector3(50e3 * 100.0 / kFocalPx, 0.0, 0.0));
  EXPECT_NEAR(half / measure(objects_of(exposure), Vector2(809.5, 599.5), 40.0).electrons, 0.5, 0.01);
}

TEST(SceneObjects, the_earth_s_shadow_darkens_an_object) {
  camera::Exposure exposure = lit_at(0.3);
  exposure.objects.push_back(object_at(exposure, Vector3(0.0, 0.0, 20e3)));
  const double full = measure(objects_of(exposure), kMiddle, 40.0).electrons;
  exposure.objects[0].sunlit = 0.25;
  EXPECT_NEAR(measure(objects_of(exposure), kMiddle, 40.0).electrons / full, 0.25, 1e-3);
  exposure.objects[0].sunlit = 0.0;
  for (const float light : objects_of(exposure).electrons) ASSERT_EQ(light, 0.0F);
}

// A picture to look at where VBAR_KEEP_IMAGES is set: build/<preset>/camera_example_<pid>.png.
TEST(SceneObjects, an_example_frame_of_orion_with_three_spacecraft) {
  camera::Exposure exposure = quiet_exposure(Vector3(std::cos(1.4704), std::sin(1.4704), -0.03));  // the belt
  exposure.rate_camera = Vector3(1.06e-3, 0.0, 0.0);
  exposure.objects.push_back(object_at(exposure, Vector3(-0.02, 0.035, 1.0) * 60e3));
  exposure.objects.push_back(object_at(exposure, Vector3(0.025, 0.05, 1.0) * 5e3));
  exposure.objects.push_back(object_at(exposure, Vector3(0.015, -0.045, 1.0) * 100.0));
  camera::PhotonImage image;
  renderer().render(exposure, image);
  const std::filesystem::path file =
      std::filesystem::path(vbar::tests::build_path()) / ("camera_example_" + std::to_string(getpid()) + ".png");
  ASSERT_TRUE(vbar::test::write_picture(image, 2000.0, file));
  if (std::getenv("VBAR_KEEP_IMAGES") == nullptr) std::filesystem::remove(file);
  // The belt's three stars, V 1.7 to 2.2, blue: 3.1e10 * 10^(-0.4 * 1.7) * 3.358e-5 electrons and less.
  std::size_t bright = 0;
  for (const float light : image.electrons) bright += light > 1e4F;
  EXPECT_GT(bright, 3U * 4U);
}

}  // namespace
