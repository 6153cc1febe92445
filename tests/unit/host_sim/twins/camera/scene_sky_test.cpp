// Whole images: stars, Sun, Moon, the Earth's limb and stray light.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/aberration.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/camera_scene.h"
#include "tests/support/figures.h"

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::Vector3;
using vbar::test::Blob;
using vbar::test::measure;
using vbar::test::quiet_exposure;
namespace camera = vbar::twins::camera;

const Vector2 kMiddle(959.5, 599.5);

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
