// The lens against the formulas written out, against finite differences, and back and forth.

#include "host_sim/twins/camera/optics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/extended_psf.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/point_spread.h"
#include "tests/support/camera_scene.h"
#include "tests/support/figures.h"

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

camera::CameraSettings distorted() {
  camera::CameraSettings settings;
  settings.optics.distortion = {-0.12, 0.08, 1.5e-3, -7e-4, 0.02};
  settings.optics.principal_point_px = {963.2, 596.7};
  return settings;
}

// As in OpenCV's documentation of camera calibration, coefficients k1, k2, p1, p2, k3.
TEST(Optics, projects_as_the_formulas_of_brown_and_conrady) {
  const camera::CameraSettings settings = distorted();
  const camera::Optics optics(settings);
  const double f = 35e-3 / 5.86e-6;
  for (const auto& d :
       {Vector3(0.0, 0.0, 1.0), Vector3(0.12, -0.05, 1.0), Vector3(-0.15, 0.09, 0.9), Vector3(0.02, 0.099, 1.1)}) {
    const double x = d.x() / d.z(), y = d.y() / d.z(), r2 = x * x + y * y;
    const double radial = 1.0 - 0.12 * r2 + 0.08 * r2 * r2 + 0.02 * r2 * r2 * r2;
    const double u = x * radial + 2.0 * 1.5e-3 * x * y - 7e-4 * (r2 + 2.0 * x * x);
    const double v = y * radial + 1.5e-3 * (r2 + 2.0 * y * y) - 2.0 * 7e-4 * x * y;
    const auto pixel = optics.project(7.0 * d);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), f * u + 963.2, 1e-9);
    EXPECT_NEAR(pixel->y(), f * v + 596.7, 1e-9);
  }
}

TEST(Optics, sees_nothing_behind_or_far_beside) {
  const camera::Optics optics{camera::CameraSettings{}};
  EXPECT_FALSE(optics.project(Vector3(0.1, 0.1, -1.0)));
  EXPECT_FALSE(optics.project(Vector3(1.0, 0.0, 0.0)));
  EXPECT_FALSE(optics.project(Vector3(3.0, 0.0, 1.0)));  // 71.6 deg
  EXPECT_FALSE(optics.project(Vector3::Zero()));
}

TEST(Optics, a_pixel_s_direction_falls_on_the_pixel) {
  const camera::Optics optics(distorted());
  for (double x = 0.0; x < 1920.0; x += 191.9)
    for (double y = 0.0; y < 1200.0; y += 119.9) {
      const Vector3 direction = optics.direction_of({x, y});
      EXPECT_NEAR(direction.norm(), 1.0, 1e-14);
      EXPECT_NEAR((*optics.project(direction) - Vector2(x, y)).norm(), 0.0, 1e-8);
    }
}

TEST(Optics, image_velocity_is_the_change_of_the_projection) {
  const camera::Optics optics(distorted());
  const Vector3 direction = Vector3(0.13, -0.08, 1.0).normalized();
  const Vector3 rate = direction.cross(Vector3(2e-3, -1e-3, 5e-3));
  const double dt = 1e-4;
  const Vector2 expected =
      (*optics.project(direction + dt * rate) - *optics.project(direction - dt * rate)) / (2.0 * dt);
  EXPECT_NEAR((optics.image_velocity(direction, rate) - expected).norm(), 0.0, 1e-6);
}

TEST(Optics, light_falls_towards_the_corners_as_the_radius_to_the_fourth) {
  const camera::Optics optics{camera::CameraSettings{}};
  EXPECT_DOUBLE_EQ(optics.vignetting({959.5, 599.5}), 1.0);
  EXPECT_NEAR(optics.vignetting({-0.5, -0.5}), 0.85, 1e-12);
  EXPECT_NEAR(optics.vignetting({959.5 + 480.0, 599.5 + 300.0}), 1.0 - 0.15 / 16.0, 1e-12);
}

TEST(Optics, the_cone_of_a_region_reaches_its_corners) {
  const camera::Optics optics{camera::CameraSettings{}};
  const camera::Cone cone = optics.cone_of({0, 0, 1920, 1200}, 0.0);
  EXPECT_NEAR((cone.axis - Vector3::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(cone.half_angle, std::atan(std::hypot(960.0, 600.0) / (35e-3 / 5.86e-6)), 1e-12);
}

}  // namespace

// Light of stars and of the Sun, against figures typed from the literature and against a black body.

namespace {

// The detector's response at 400, 500, ... 900 nm, by eye.
constexpr std::array<double, 6> kResponse{0.71, 1.00, 0.91, 0.68, 0.39, 0.17};

double response(double nm) {
  const double place = (nm - 400.0) / 100.0;
  const auto i = static_cast<std::size_t>(place < 4.999 ? place : 4.999);
  return kResponse[i] + (kResponse[i + 1] - kResponse[i]) * (place - static_cast<double>(i));
}

// By hand, trapezia of 50 nm from 400 nm. Photons/(cm^2 s A) of V = 0, B-V = 0 read off the straight lines on
// logarithmic paper through 1394 at 438 nm (B), 996 at 545 (V; the well-known 1000), 702 at 641 (R), 452 at 798 (I).
TEST(Photometry, magnitude_zero_is_what_the_bands_sum_to_by_hand) {
  constexpr std::array<double, 11> kPhotons{1571, 1342, 1147, 978, 815, 684, 595, 517, 450, 391, 340};
  constexpr std::array<double, 11> kSeen{0.71, 0.94, 1.00, 0.99, 0.91, 0.81, 0.68, 0.53, 0.39, 0.27, 0.17};
  double photons = 0.0;  // 1/(m^2 s)
  for (std::size_t i = 0; i + 1 < kSeen.size(); ++i)
    photons += 0.5 * (kPhotons[i] * kSeen[i] + kPhotons[i + 1] * kSeen[i + 1]) * 500.0 * 1e4;
  EXPECT_NEAR(camera::zero_magnitude_photons_from_spectrum() / photons, 1.0, 0.01);
}

TEST(Photometry, the_camera_settings_hold_it_rounded) {
  EXPECT_NEAR(camera::CameraSettings{}.zero_magnitude_photons / camera::zero_magnitude_photons_from_spectrum(), 1.0,
              0.01);
}

TEST(Photometry, the_sun_shines_like_a_black_body_of_5772_kelvin) {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458.0, kBoltzmann = 1.380649e-23;
  double photons = 0.0;  // of a surface into the hemisphere, 1/(m^2 s)
  for (double nm = 400.5; nm < 900.0; nm += 1.0) {
    const double wave = nm * 1e-9;
    const double radiance =
        2.0 * kLight / std::pow(wave, 4) / std::expm1(kPlanck * kLight / (wave * kBoltzmann * 5772.0));
    photons += M_PI * radiance * 1e-9 * response(nm);
  }
  photons *= std::pow(6.957e8 / 1.495978707e11, 2);
  // The Sun is some per cent brighter than the black body in the visible and fainter in the violet.
  EXPECT_NEAR(camera::sun_photons(3.1e10, 1.495978707e11) / photons, 1.0, 0.06);
}

TEST(Photometry, sunlight_falls_with_the_square_of_the_distance) {
  EXPECT_NEAR(camera::sun_photons(1.0, 3.0e11) / camera::sun_photons(1.0, 1.5e11), 0.25, 1e-12);
}

TEST(Photometry, five_magnitudes_are_a_factor_of_a_hundred) {
  EXPECT_DOUBLE_EQ(camera::star_photons(3.1e10, 0.0, 0.0), 3.1e10);
  EXPECT_NEAR(camera::star_photons(3.1e10, 5.0, 0.0) / 3.1e8, 1.0, 1e-12);
}

TEST(Photometry, red_stars_give_more_electrons_than_white_ones_of_the_same_magnitude) {
  EXPECT_DOUBLE_EQ(camera::colour_factor(0.0), 1.0);
  EXPECT_GT(camera::colour_factor(1.5), 1.2);  // V-I of 1.6: four times the light at 800 nm
  EXPECT_LT(camera::colour_factor(1.5), 1.5);
  EXPECT_NEAR(camera::colour_factor(-0.3), 1.07, 0.05);
  EXPECT_EQ(camera::colour_factor(5.0), camera::colour_factor(1.7));
  EXPECT_EQ(camera::colour_factor(-5.0), camera::colour_factor(-0.3));
}

}  // namespace

// A point's image against numerical integration of the moving Gaussians over every pixel, and what must hold of any sum
// of points: flux and centroid.

namespace {

using vbar::test::Blob;
using vbar::test::measure;

constexpr camera::Region kRegion{100, 200, 120, 100};
const Vector2 kMiddle(160.0, 250.0);

camera::PhotonImage black() {
  return {kRegion, std::vector<float>(static_cast<std::size_t>(kRegion.width * kRegion.height), 0.0F)};
}

camera::PhotonImage image_of(const camera::ImagePoint& point, const Vector2& smear_px) {
  camera::PhotonImage image = black();
  camera::PointSpread(camera::OpticsSettings{}).add(point, smear_px, image);
  return image;
}

Blob whole(const camera::PhotonImage& image) {
  return measure(image, kMiddle, 60.0);
}

TEST(PointSpread, centroid_and_flux_hold_at_every_place_within_a_pixel) {
  for (double u = 0.0; u < 1.0; u += 0.125)
    for (double v = 0.0; v < 1.0; v += 0.25) {
      const camera::ImagePoint point{kMiddle + Vector2(u, v), 1000.0};
      for (const Vector2& smear : {Vector2(0.0, 0.0), Vector2(1.27, 0.0), Vector2(-0.4, 0.9), Vector2(13.0, 5.0)}) {
        const Blob blob = whole(image_of(point, smear));
        EXPECT_NEAR(blob.electrons, 1000.0, 0.1);                       // 1e-4
        EXPECT_NEAR((blob.centroid - point.pixel).norm(), 0.0, 0.001);  // the project allows 0.02
      }
    }
}

// Second moments add: core and halo, the pixel's own 1/12, the smear's L^2/12.
TEST(PointSpread, second_moments_are_those_of_spread_pixel_and_smear) {
  const Vector2 smear(1.8, -0.9);
  const Blob blob = whole(image_of({kMiddle + Vector2(0.3, -0.2), 1e7}, smear));
  const double own = 0.99 * 0.64 + 0.01 * 16.0 + 1.0 / 12.0;
  EXPECT_NEAR(blob.spread(0, 0), own + smear.x() * smear.x() / 12.0, 1e-3);
  EXPECT_NEAR(blob.spread(1, 1), own + smear.y() * smear.y() / 12.0, 1e-3);
  EXPECT_NEAR(blob.spread(0, 1), smear.x() * smear.y() / 12.0, 1e-3);
}

// Slow and simple: 20 x 20 places in a pixel, 400 instants.
TEST(PointSpread, pixels_agree_with_numerical_integration) {
  const Vector2 place = kMiddle + Vector2(0.37, -0.41), smear(2.1, 1.1);
  const camera::PhotonImage image = image_of({place, 1e6}, smear);
  const auto density = [](const Vector2& off, double sigma) {
    return std::exp(-0.5 * off.squaredNorm() / (sigma * sigma)) / (2.0 * M_PI * sigma * sigma);
  };
  for (const Vector2& pixel :
       {Vector2(160, 250), Vector2(161, 249), Vector2(163, 251), Vector2(158, 247), Vector2(168, 250)}) {
    double sum = 0.0;
    for (int instant = 0; instant < 400; ++instant)
      for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j) {
          const Vector2 in_pixel((i + 0.5) / 20.0 - 0.5, (j + 0.5) / 20.0 - 0.5);
          const Vector2 off = pixel + in_pixel - place - ((instant + 0.5) / 400.0 - 0.5) * smear;
          sum += 0.99 * density(off, 0.8) + 0.01 * density(off, 4.0);
        }
    const double expected = 1e6 * sum / (400.0 * 400.0);
    const double found = measure(image, pixel, 0.1).electrons;
    EXPECT_NEAR(found, expected, 1e-3 * expected + 0.05) << pixel.transpose();
  }
}

TEST(PointSpread, a_bright_point_is_drawn_until_its_light_is_lost) {
  const camera::PointSpread spread{camera::OpticsSettings{}};
  EXPECT_GT(spread.reach_px(5e8), 19.0);  // a spacecraft at 1 km
  EXPECT_LT(spread.reach_px(5e8), 30.0);
  const camera::PhotonImage image = image_of({kMiddle, 5e8}, Vector2::Zero());
  EXPECT_NEAR(whole(image).electrons / 5e8, 1.0, 1e-4);
  // Halo at 17 px: 0.01 of the light, integrals of a normal distribution of sigma 4 over the pixel.
  const double across = 0.5 * (std::erfc(16.5 / 4.0 * M_SQRT1_2) - std::erfc(17.5 / 4.0 * M_SQRT1_2));
  const double down = std::erf(0.5 / 4.0 * M_SQRT1_2);
  EXPECT_NEAR(measure(image, kMiddle + Vector2(17.0, 0.0), 0.1).electrons, 5e6 * across * down, 0.01);
}

TEST(PointSpread, only_the_part_within_the_region_is_drawn) {
  // On the region's left edge, half way into a pixel: half of the light.
  EXPECT_NEAR(whole(image_of({Vector2(99.5, 250.0), 1000.0}, Vector2::Zero())).electrons, 500.0, 0.1);
  for (const Vector2& outside : {Vector2(-500.0, 250.0), Vector2(160.0, 1e6), Vector2(std::nan(""), 250.0)}) {
    for (const float light : image_of({outside, 1000.0}, Vector2::Zero()).electrons) ASSERT_EQ(light, 0.0F);
  }
}

TEST(PointSpread, many_points_give_the_image_of_each) {
  camera::PointSpread spread{camera::OpticsSettings{}};
  for (const double extent : {1e-4, 0.3, 5.0, 40.0}) {
    std::vector<camera::ImagePoint> points;
    for (int i = 0; i < 400; ++i)  // a lopsided cloud
      points.push_back(
          {kMiddle + extent * Vector2(std::sin(1.0 * i) * 0.5, std::cos(2.3 * i) * 0.4 + 0.05 * std::sin(9.0 * i)),
           10.0 + i % 7});
    for (const Vector2& smear : {Vector2(0.0, 0.0), Vector2(1.3, 0.4)}) {
      camera::PhotonImage together = black(), each = black();
      spread.add(points, smear, together);
      for (const camera::ImagePoint& point : points) spread.add(point, smear, each);
      const Blob a = whole(together), b = whole(each);
      EXPECT_NEAR(a.electrons / b.electrons, 1.0, 2e-4);
      EXPECT_NEAR((a.centroid - b.centroid).norm(), 0.0, 0.001);
      // Gathering widens by a twentieth of the core's variance at most.
      EXPECT_NEAR((a.spread - b.spread).norm() / b.spread.norm(), 0.0, 0.03) << extent;
    }
  }
}

// Beyond kWide_px another grid takes over: each pixel against the sum of its points, with the wide lens of one camera
// and the fine one of another, across the change and far beyond it.
TEST(PointSpread, wide_things_give_the_image_of_each_of_their_points) {
  constexpr camera::Region kLarge{100, 200, 320, 260};
  const Vector2 middle(262.3, 330.6);
  for (const double sigma : {0.3, 0.8}) {
    camera::OpticsSettings optics;
    optics.point_spread_sigma_px = sigma;
    optics.halo_sigma_px = 2.5;
    camera::PointSpread spread(optics);
    for (const double extent : {95.0, 97.0, 250.0, 400.0})  // the last hangs over all four edges
      for (const Vector2& smear : {Vector2(0.0, 0.0), Vector2(1.3, 0.4)}) {
        std::vector<camera::ImagePoint> points;
        for (int i = 0; i < 60; ++i)
          for (int j = 0; j < 60; ++j)
            points.push_back({middle + extent * Vector2(i / 59.0 - 0.5, 0.8 * (j / 59.0 - 0.5)), 2e3 + (i * j) % 700});
        camera::PhotonImage together{kLarge, std::vector<float>(320 * 260, 0.0F)}, each = together;
        spread.add(points, smear, together);
        for (const camera::ImagePoint& point : points) spread.add(point, smear, each);
        double sum_together = 0.0, sum_each = 0.0, squares = 0.0;
        vbar::accuracy::Largest brightest;
        Vector2 first_together = Vector2::Zero(), first_each = Vector2::Zero();
        for (int y = 0; y < kLarge.height; ++y)
          for (int x = 0; x < kLarge.width; ++x) {
            const double a = together.at(kLarge.x + x, kLarge.y + y), b = each.at(kLarge.x + x, kLarge.y + y);
            sum_together += a;
            sum_each += b;
            first_together += a * Vector2(x, y);
            first_each += b * Vector2(x, y);
            squares += (a - b) * (a - b);
            brightest.add(b);
          }
        EXPECT_NEAR(sum_together / sum_each, 1.0, 2e-4) << extent << ' ' << sigma;
        EXPECT_NEAR((first_together / sum_together - first_each / sum_each).norm(), 0.0, 0.01)
            << extent << ' ' << sigma;
        // Each point stands alone here, so gathering shows: by a few per cent of a point's peak, as above.
        EXPECT_LT(std::sqrt(squares / (320.0 * 260.0)), 0.02 * brightest) << extent << ' ' << sigma;
      }
  }
}

// An even face, its points in rows half a pixel apart, more or less: no ripple where grid and rows beat.
TEST(PointSpread, an_even_face_is_even) {
  constexpr camera::Region kLarge{0, 0, 200, 200};
  camera::OpticsSettings optics;
  optics.point_spread_sigma_px = 0.3;
  optics.halo_fraction = 0.0;
  camera::PointSpread spread(optics);
  for (const double pitch : {0.37, 0.41, 0.45, 0.5}) {
    std::vector<camera::ImagePoint> points;
    for (double x = 20.0; x < 180.0; x += pitch)
      for (double y = 20.0; y < 180.0; y += pitch) points.push_back({{x, y}, 1e4 * pitch * pitch});
    camera::PhotonImage image{kLarge, std::vector<float>(200 * 200, 0.0F)};
    spread.add(points, Vector2::Zero(), image);
    for (int y = 40; y < 160; ++y)
      for (int x = 40; x < 160; ++x) ASSERT_NEAR(image.at(x, y), 1e4, 30.0) << pitch;  // shot noise is 100
  }
}

TEST(PointSpread, no_points_and_points_outside_change_nothing) {
  camera::PointSpread spread{camera::OpticsSettings{}};
  camera::PhotonImage image = black();
  spread.add(std::vector<camera::ImagePoint>{}, Vector2::Zero(), image);
  spread.add(std::vector<camera::ImagePoint>{{Vector2(-1e5, 3.0), 1e9}, {Vector2(std::nan(""), 3.0), 1.0}},
             Vector2::Zero(), image);
  for (const float light : image.electrons) ASSERT_EQ(light, 0.0F);
}

// A body right beside the camera has corners at pixels a million away; only those near the region cost anything.
TEST(ExtendedPsf, points_far_aside_change_nothing) {
  const camera::OpticsSettings optics;
  camera::ExtendedPsf spread({optics.point_spread_sigma_px, optics.halo_sigma_px, optics.halo_fraction});
  std::vector<camera::ImagePoint> points{{kMiddle, 1000.0}, {kMiddle + Vector2(30.2, 4.7), 500.0}};
  camera::PhotonImage alone = black();
  spread.add(points, Vector2::Zero(), 5.0, 20.0, alone);
  points.push_back({Vector2(3e6, -2e6), 1e6});
  points.push_back({Vector2(-4e6, 1e6), 1e6});
  camera::PhotonImage with_others = black();
  spread.add(points, Vector2::Zero(), 5.0, 20.0, with_others);
  EXPECT_EQ(with_others.electrons, alone.electrons);
  camera::PhotonImage far_smeared = black();
  spread.add(points, Vector2(3e7, -1e7), 5.0, 20.0, far_smeared);
  EXPECT_EQ(far_smeared.electrons, alone.electrons);
  EXPECT_NEAR(whole(alone).electrons, 1500.0, 1.0);
}

}  // namespace
