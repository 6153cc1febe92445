// Light of plates and spheres against formulas, of Tango against itself: the inverse square, finer pictures,
// repetition.

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/twins/camera/model/light_sums.h"
#include "tests/unit/host_sim/twins/camera/model/shapes.h"

namespace vbar::twins::camera {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kPi = std::numbers::pi;

CadModel tango() {
  return load_cad_model(vbar::tests::source_path("data/models/tango.obj"));
}

CadModel sphere(double radius, double albedo) {
  std::vector<Triangle> triangles;
  shapes::add_sphere(triangles, Vector3::Zero(), radius, 48);
  return shapes::model_of(triangles, shapes::lambert(albedo));
}

// 0.8 m by 0.5 m, facing +z of the body.
CadModel plate(const Material& material) {
  std::vector<Triangle> triangles;
  shapes::add_plate(triangles, Vector3(-0.4, -0.25, 0.0), Vector3(0.8, 0.0, 0.0), Vector3(0.0, 0.5, 0.0));
  return shapes::model_of(triangles, material);
}
constexpr double kPlateArea = 0.4;

// A turn that puts every edge at an angle to the rows of the picture.
Matrix3 turned(double about_x, double about_y, double about_z) {
  return (Eigen::AngleAxisd(about_x, Vector3::UnitX()) * Eigen::AngleAxisd(about_y, Vector3::UnitY()) *
          Eigen::AngleAxisd(about_z, Vector3::UnitZ()))
      .toRotationMatrix();
}

Light light_of(TargetRenderer& renderer, const TargetView& view) {
  std::vector<LightSample> samples;
  renderer.render(view, samples);
  return sum_of(samples);
}

TEST(TargetFlux, OfALambertSphereIsTheHandFormulas) {
  // Flux = E albedo (R/d)^2 2/(3 pi) ((pi - a) cos a + sin a) at phase angle a. Its centroid lies
  // R (3 pi/16) sin a (1 + cos a) / ((pi - a) cos a + sin a) from the middle towards the Sun: both are integrals of
  // mu mu0 over the part that is lit and seen, with longitude and latitude from the scattering plane. At half phase
  // the latter is the known 3 pi/16.
  const double radius = 0.35, albedo = 0.3;
  TargetRenderer renderer(sphere(radius, albedo));
  for (const double range : {200.0, 5.0e3, 75.0e3})
    for (const double phase : {0.0, 0.5 * kPi, 0.75 * kPi}) {
      const Light light = light_of(renderer, view_at(range, phase));
      const double lune = (kPi - phase) * std::cos(phase) + std::sin(phase);
      const double expected = kSunPhotons * albedo * std::pow(radius / range, 2) * 2.0 / (3.0 * kPi) * lune;
      EXPECT_NEAR(light.flux / expected, 1.0, 0.01) << range << " m, phase " << phase;
      const double offset = radius * 3.0 * kPi / 16.0 * std::sin(phase) * (1.0 + std::cos(phase)) / lune;
      EXPECT_NEAR(light.direction.x() * range, offset, 0.005 * radius) << range << " m, phase " << phase;
      EXPECT_NEAR(light.direction.y() * range, 0.0, 0.002 * radius) << range << " m, phase " << phase;
    }
}

TEST(TargetFlux, OfALambertPlateIsTheHandFormulas) {
  // E cos(incidence) albedo/pi times area cos(emission)/d^2.
  const double albedo = 0.6;
  TargetRenderer renderer(plate(shapes::lambert(albedo)));
  for (const double range : {50.0, 3.0e3, 75.0e3})
    for (const double phase : {0.0, 0.6, 1.2}) {
      TargetView view = view_at(range, phase);
      view.R_camera_body = turned(kPi - 0.3, 0.4, 0.5);  // its front to the camera
      const Vector3 normal = view.R_camera_body.col(2);
      const double incidence = normal.dot(view.sun_camera), emission = -normal.z();
      ASSERT_GT(incidence, 0.1);
      ASSERT_GT(emission, 0.1);
      const double expected = kSunPhotons * incidence * albedo / kPi * kPlateArea * emission / (range * range);
      EXPECT_NEAR(light_of(renderer, view).flux / expected, 1.0, 0.02) << range << " m, phase " << phase;
    }
}

TEST(TargetFlux, IsNoneFromThePlatesUnlitSideAndIsProportionalToTheSun) {
  TargetRenderer renderer(plate(shapes::lambert(0.5)));
  TargetView view = view_at(1.0e3, 0.0);
  view.R_camera_body = turned(0.3, 0.2, 0.1);
  const double full = light_of(renderer, view).flux;
  EXPECT_GT(full, 0.0) << "a sheet is seen from its back, too";
  view.sunlit = 0.25;
  EXPECT_NEAR(light_of(renderer, view).flux, 0.25 * full, 1e-6 * full);
  view.sunlit = 0.0;
  EXPECT_EQ(light_of(renderer, view).flux, 0.0);
  view.sunlit = 1.0;
  view.sun_camera = Vector3(0.1, 0.0, 1.0).normalized();
  EXPECT_EQ(light_of(renderer, view).flux, 0.0);
}

TEST(TargetFlux, OfTheEarthsLightIsTheIntegralOverItsDisc) {
  // Irradiance of a tilted plate: cos(incidence), where positive, summed over the disc.
  const double half_angle = 1.1, albedo = 0.5, earth = 2.0e20, range = 500.0;
  TargetRenderer renderer(plate(shapes::lambert(albedo)));
  for (const double tilt : {0.0, 0.4, 1.0, 1.4, 1.9, 2.5}) {
    TargetView view;
    view.position_camera = Vector3(0.0, 0.0, range);
    view.R_camera_body = turned(kPi, 0.0, 0.4);
    view.earth_photons_per_m2_s = earth;
    view.earth_half_angle = half_angle;
    view.nadir_camera = Vector3(std::sin(tilt), 0.0, -std::cos(tilt));
    double sum = 0.0, facing = 0.0;
    constexpr int kSteps = 400;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double off = half_angle * (i + 0.5) / kSteps, around = 2.0 * kPi * (j + 0.5) / kSteps;
        const double cosine = std::cos(tilt) * std::cos(off) + std::sin(tilt) * std::sin(off) * std::cos(around);
        sum += std::sin(off) * std::max(0.0, cosine);
        facing += std::sin(off) * std::cos(off);
      }
    const double expected = earth * sum / facing * albedo / kPi * kPlateArea / (range * range);
    const double whole = earth * albedo / kPi * kPlateArea / (range * range);
    EXPECT_NEAR(light_of(renderer, view).flux, expected, 0.01 * whole) << "tilt " << tilt;
  }
}

TEST(TargetFlux, FallsWithTheSquareOfTheRange) {
  TargetRenderer renderer(tango());
  TargetView view = view_at(1.0e3, 1.0);
  view.R_camera_body = turned(1.0, 0.4, 0.3);
  view.texel_pitch = 0.5 / 5972.7;
  const double near = light_of(renderer, view).flux * 1e6;
  for (const double range : {3.0e3, 10.0e3, 30.0e3, 75.0e3}) {
    view.position_camera.z() = range;
    EXPECT_NEAR(light_of(renderer, view).flux * range * range / near, 1.0, 0.005) << range;
  }
}

TEST(TargetFlux, AndCentroidStayWithFinerPictures) {
  // In the coarsest picture the panel's grid lines and the antennas are thinner than a texel, 12 mm: some
  // tenths of a per cent of the light.
  TargetRenderer renderer(tango());
  const double range = 500.0;
  for (const double turn : {0.3, 1.7, 2.9, 4.4}) {
    TargetView view = view_at(range, 0.8);
    view.R_camera_body = turned(0.9 + turn, 0.4 * turn, turn);
    const Light coarse = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 128);
    view.texel_pitch = 2.0 * 0.75 / range / 250.0;
    const Light middle = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 256);
    view.texel_pitch *= 0.5;  // one sample a texel from here on: no more of them than in the middle picture
    const Light single = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 512);
    view.texel_pitch *= 0.5;
    const Light fine = light_of(renderer, view);
    ASSERT_EQ(renderer.texels(), 1024);
    EXPECT_NEAR(coarse.flux / fine.flux, 1.0, 0.01) << turn;
    EXPECT_NEAR(middle.flux / fine.flux, 1.0, 0.005) << turn;
    EXPECT_NEAR(single.flux / fine.flux, 1.0, 0.005) << turn;
    EXPECT_LT((coarse.direction - fine.direction).norm() * range, 0.002) << turn;
    EXPECT_LT((middle.direction - fine.direction).norm() * range, 0.001) << turn;
    EXPECT_LT((single.direction - fine.direction).norm() * range, 0.001) << turn;
  }
}

TEST(TargetFlux, IsTheSameBitsAgainAndInAnotherThread) {
  TargetRenderer renderer(tango());
  TargetView view = view_at(120.0, 1.1);
  view.R_camera_body = turned(0.2, 1.0, 2.0);
  view.texel_pitch = 0.5 / 5972.7;
  std::vector<LightSample> first, other, again;
  renderer.render(view, first);
  ASSERT_GT(first.size(), 1000U);
  std::thread([&] {
    TargetView far = view;
    far.position_camera.z() = 75.0e3;
    renderer.render(far, other);
    renderer.render(view, again);
  }).join();
  TargetRenderer second(tango());
  second.render(view, other);
  const auto same = [&first](const std::vector<LightSample>& samples) {
    if (samples.size() != first.size()) return false;
    for (std::size_t i = 0; i < first.size(); ++i)
      if (samples[i].direction_camera != first[i].direction_camera ||
          samples[i].photons_per_m2_s != first[i].photons_per_m2_s)
        return false;
    return true;
  };
  EXPECT_TRUE(same(again)) << "after another view, in a worker thread";
  EXPECT_TRUE(same(other)) << "by another renderer, while the first one lives";
}

TEST(TargetFlux, FollowsOtherMaterials) {
  CadModel model = sphere(0.35, 0.2);
  TargetRenderer renderer(model);
  const TargetView view = view_at(1.0e3, 1.0);
  const double dark = light_of(renderer, view).flux;
  renderer.set_materials(std::array{shapes::lambert(0.6)});
  EXPECT_NEAR(light_of(renderer, view).flux / dark, 3.0, 1e-5);
  EXPECT_THROW(renderer.set_materials(std::array{shapes::lambert(0.6), shapes::lambert(0.1)}), std::runtime_error);
  EXPECT_THROW(renderer.set_materials(std::array{shapes::lambert(1.2)}), std::runtime_error);
  EXPECT_NEAR(light_of(renderer, view).flux / dark, 3.0, 1e-5) << "bad materials change nothing";
}

TEST(TargetView, InsideTheBodyOrWithoutNumbersIsRefused) {
  TargetRenderer renderer(sphere(0.35, 0.2));
  std::vector<LightSample> samples;
  EXPECT_THROW(renderer.render(view_at(0.3, 1.0), samples), std::invalid_argument);
  EXPECT_NO_THROW(renderer.render(view_at(0.4, 1.0), samples));
  TargetView view = view_at(10.0, 1.0);
  view.R_camera_body(1, 2) = std::nan("");
  EXPECT_THROW(renderer.render(view, samples), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::twins::camera
