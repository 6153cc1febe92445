// Spacecraft in the image: their light, their place, and that nothing jumps between a point and a disc.

#include "host_sim/twins/camera/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/twins/camera/object_view.h"
#include "host_sim/twins/camera/star_sky.h"
#include "tests/support/camera_scene.h"
#include "tests/support/figures.h"
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

// Whole images: stars, Sun, Moon, the Earth's limb and stray light.

namespace {

camera::SceneRenderer& sky_renderer() {
  static camera::SceneRenderer made(camera::CameraSettings{}, vbar::test::camera_data());
  return made;
}

camera::PhotonImage image_of(const camera::Exposure& exposure) {
  camera::PhotonImage image;
  sky_renderer().render(exposure, image);
  return image;
}

double least(const camera::PhotonImage& image) {
  vbar::accuracy::Smallest least;
  for (const float electrons : image.electrons) least.add(electrons);
  return least;
}

// A direction as its right ascension and declination, degrees.
Vector3 towards(double ra_deg, double dec_deg) {
  const double ra = ra_deg * M_PI / 180.0, dec = dec_deg * M_PI / 180.0;
  return {std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec)};
}

const Vector3 kVega = towards(279.2347, 38.7837);

// Vega, V = 0.03, B-V = 0.00. By hand: 3.1e10 photons/(m^2 s) of magnitude 0 times 10^(-0.012) = 3.015e10; pupil of
// 18.42 mm, 2.665e-4 m^2; glass 0.9; detector 0.7; 0.2 s: 1.0126e6 electrons.
TEST(SceneSky, a_star_of_magnitude_zero_gives_the_electrons_of_a_hand_calculation) {
  const Blob vega = measure(image_of(quiet_exposure(kVega)), kMiddle, 40.0);
  EXPECT_NEAR(vega.electrons / 1.0126e6, 1.0, 0.02);
}

// Proper motion of 0.35 arcsec a year for 11.55 years and 28 km/s of aberration, by hand; a pixel is 34.5 arcsec.
TEST(SceneSky, a_star_stands_where_motion_and_aberration_put_it) {
  const camera::Exposure exposure = quiet_exposure(kVega);
  const double mas = M_PI / 6.48e8;
  const Vector3 east = Vector3::UnitZ().cross(kVega).normalized();
  const Vector3 north = kVega.cross(east);
  const Vector3 now = kVega + 11.55 * mas * (200.94 * east + 286.23 * north);
  const Vector3 velocity = exposure.earth_velocity_bcrs + exposure.camera_velocity_eci;
  const Vector3 seen = exposure.q_camera_eci * (now + velocity / 299792458.0);  // first order: 1 milliarcsecond
  const Vector2 expected = kMiddle + 35.0 / 5.86e-3 * seen.head<2>() / seen.z();
  const Blob vega = measure(image_of(exposure), expected, 8.0);
  EXPECT_NEAR((vega.centroid - expected).norm(), 0.0, 0.02);
  EXPECT_GT((expected - kMiddle).norm(), 0.3);  // it is not just the middle
}

// Turning with the orbit about the camera's x axis: stars are drawn out along y by 1.06e-3 * 0.2 * 5972.7 = 1.266 px,
// but their middle stays.
TEST(SceneSky, stars_are_drawn_out_by_the_camera_s_turning) {
  const Blob still = measure(image_of(quiet_exposure(kVega)), kMiddle, 8.0);
  camera::Exposure exposure = quiet_exposure(kVega);
  exposure.rate_camera = Vector3(1.06e-3, 0.0, 0.0);
  const Blob moving = measure(image_of(exposure), kMiddle, 8.0);
  EXPECT_NEAR((moving.centroid - still.centroid).norm(), 0.0, 0.002);
  EXPECT_NEAR(moving.spread(1, 1) - still.spread(1, 1), 1.266 * 1.266 / 12.0, 0.003);
  EXPECT_NEAR(moving.spread(0, 0) - still.spread(0, 0), 0.0, 0.001);
  EXPECT_NEAR(moving.electrons / still.electrons, 1.0, 1e-4);
}

TEST(SceneSky, stars_move_against_the_camera) {
  // Turning about +x by the right hand carries the boresight from z towards -y; stars go to +y.
  camera::Exposure exposure = quiet_exposure(kVega);
  const Blob before = measure(image_of(exposure), kMiddle, 8.0);
  exposure.q_camera_eci = Eigen::AngleAxisd(-3.0 / 5972.7, Vector3::UnitX()) * exposure.q_camera_eci;
  const Blob after = measure(image_of(exposure), kMiddle + Vector2(0.0, 3.0), 8.0);
  EXPECT_NEAR((after.centroid - before.centroid - Vector2(0.0, 3.0)).norm(), 0.0, 0.01);
}

TEST(SceneSky, the_same_exposure_gives_the_same_bits) {
  camera::Exposure exposure = quiet_exposure(towards(84.0, -1.0));
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(3.0, 2.0, 900.0)));
  const camera::PhotonImage first = image_of(exposure);
  (void)image_of(quiet_exposure(kVega));
  EXPECT_EQ(image_of(exposure).electrons, first.electrons);
}

// Stray light falls with the square from the field's edge (10.7 deg) to nothing at 30 deg; with the Sun at 20.4 deg
// half way, a quarter of 2e4 * 0.2 electrons.
TEST(SceneSky, the_sun_near_the_field_lights_the_baffle) {
  const camera::PhotonImage quiet = image_of(quiet_exposure(kVega));
  const auto with_sun_at = [](double off_deg) {
    camera::Exposure exposure = quiet_exposure(kVega);
    const double off = off_deg * M_PI / 180.0;
    exposure.sun_eci =
        vbar::test::kSunDistance * (exposure.q_camera_eci.conjugate() * Vector3(0.0, -std::sin(off), std::cos(off)));
    return image_of(exposure);
  };
  const double edge_deg = std::atan(std::hypot(960.0 + 64.0, 600.0 + 64.0) * 5.86e-3 / 35.0) * 180.0 / M_PI;
  const auto middle_level = [&](const camera::PhotonImage& image) {
    return measure(vbar::test::difference(image, quiet), kMiddle, 100.0).electrons / (200.0 * 200.0);
  };
  EXPECT_EQ(with_sun_at(31.0).electrons, quiet.electrons);
  EXPECT_NEAR(middle_level(with_sun_at(0.5 * (30.0 + edge_deg))), 1000.0, 10.0);
  const camera::PhotonImage stray = vbar::test::difference(with_sun_at(12.0), quiet);
  EXPECT_GT(measure(stray, Vector2(959.5, 250.0), 40.0).electrons,
            1.2 * measure(stray, Vector2(959.5, 950.0), 40.0).electrons);
}

TEST(SceneSky, the_sun_in_the_field_saturates_all_of_it) {
  camera::Exposure exposure = quiet_exposure(kVega);
  exposure.sun_eci =
      vbar::test::kSunDistance * (exposure.q_camera_eci.conjugate() * Vector3(0.03, 0.02, 1.0).normalized());
  EXPECT_GT(least(image_of(exposure)), 1e6);  // a full well is 32,000
}

TEST(SceneSky, the_sun_behind_the_earth_disturbs_nothing) {
  camera::Exposure exposure = quiet_exposure(kVega);
  const Vector3 nadir = -exposure.camera_position_eci.normalized();
  const camera::PhotonImage quiet = image_of(exposure);
  exposure.sun_eci = vbar::test::kSunDistance * nadir;
  EXPECT_EQ(image_of(exposure).electrons, quiet.electrons);
  // And in the field, but behind the Earth: the night side hides Sun and stars.
  exposure.q_camera_eci = vbar::test::camera_attitude(nadir, kVega);
  for (const float light : image_of(exposure).electrons) ASSERT_EQ(light, 0.0F);
}

// Full, at its mean distance: V = -12.73, and 1.05 for its colour.
TEST(SceneSky, the_moon_is_a_disc_of_its_magnitude) {
  camera::Exposure exposure = quiet_exposure(kVega);
  const camera::PhotonImage quiet = image_of(exposure);
  exposure.moon_eci = exposure.camera_position_eci + 3.844e8 * kVega;
  exposure.sun_eci = -vbar::test::kSunDistance * kVega;
  const camera::PhotonImage image = vbar::test::difference(image_of(exposure), quiet);
  const Blob moon = measure(image, kMiddle, 80.0);
  EXPECT_NEAR(moon.electrons / (3.1e10 * std::pow(10.0, 0.4 * 12.73) * 3.358e-5 * 1.05), 1.0, 0.03);
  const double radius_px = std::tan(std::asin(1.7374e6 / 3.844e8)) * 5972.7;
  EXPECT_NEAR(moon.spread(0, 0), radius_px * radius_px / 4.0, 0.02 * radius_px * radius_px);
  // Only the camera's way around the Earth moves it: 7.5 km/s along the boresight, not at all.
  EXPECT_NEAR((moon.centroid - kMiddle).norm(), 0.0, 0.05);
  // Veiling glare: a thousandth of the light, spread over all the detector.
  EXPECT_NEAR(measure(image, Vector2(730.0, 230.0), 10.0).electrons / 441.0, 1e-3 * moon.electrons / (1920.0 * 1200.0),
              0.02 * 1e-3 * moon.electrons / (1920.0 * 1200.0));
}

camera::Exposure towards_the_limb(const Vector3& sun_direction) {
  camera::Exposure exposure = quiet_exposure(Vector3::UnitY());
  exposure.camera_position_eci = Vector3(7.0e6, 0.0, 0.0);
  const double horizon = std::asin(6378137.0 / 7.0e6);  // from the nadir, in the equator's plane
  const Vector3 limb(-std::cos(horizon), std::sin(horizon), 0.0);
  exposure.q_camera_eci = vbar::test::camera_attitude(limb, -Vector3::UnitX());
  exposure.sun_eci = vbar::test::kSunDistance * sun_direction;
  return exposure;
}

// Sun above the camera. Where the line of sight meets the ground, the Sun is as far from the zenith as that place is
// from the point below the camera.
TEST(SceneSky, the_earth_s_day_side_ends_at_the_limb) {
  const camera::PhotonImage image = image_of(towards_the_limb(Vector3::UnitX()));
  const double above = measure(image, kMiddle - Vector2(0.0, 40.0), 10.0).electrons / 400.0;
  const double below = measure(image, kMiddle + Vector2(0.0, 40.0), 10.0).electrons / 400.0;
  const double ratio = 7.0e6 / 6378137.0;
  const double nadir_angle = std::asin(1.0 / ratio) - std::atan(40.0 / 5972.7);
  const double from_nadir = std::asin(ratio * std::sin(nadir_angle)) - nadir_angle;
  // Radiance: sunlight of 1.546e21 photons/(m^2 s) * 0.3/pi * cosine; a pixel sees (1/5972.7)^2 sr.
  const double expected = 1.546e21 * 0.3 / M_PI * std::cos(from_nadir) / (5972.7 * 5972.7) * 3.358e-5;
  EXPECT_NEAR((below - above) / expected, 1.0, 0.02);
  EXPECT_GT(above, 32000.0);  // its glare drowns the stars, as in a real camera
}

TEST(SceneSky, the_earth_s_night_side_hides_stars_and_objects) {
  camera::Exposure exposure = towards_the_limb(-Vector3::UnitX());
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(0.0, 300.0, 75e3)));   // before the Earth
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(0.0, 2.0e5, 2.0e7)));  // behind it
  const camera::PhotonImage image = image_of(exposure);
  const auto lit_in = [&](double y, double half) { return measure(image, Vector2(959.5, y), half).electrons; };
  EXPECT_GT(lit_in(400.0, 190.0), 0.0);          // stars above the limb
  EXPECT_GT(lit_in(599.5 + 24.0, 8.0), 1000.0);  // the object before the Earth
  EXPECT_EQ(lit_in(599.5 + 60.0, 10.0), 0.0);
  EXPECT_EQ(lit_in(850.0, 140.0), 0.0);
}

}  // namespace
