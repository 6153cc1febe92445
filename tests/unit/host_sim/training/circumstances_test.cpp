#include "host_sim/training/circumstances.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/data_directory.h"
#include "host_sim/twins/camera/photometry.h"
#include "tests/support/figures.h"

namespace vbar::training {
namespace {

constexpr double kDegree = M_PI / 180.0;

std::vector<Circumstances> draw(int count) {
  const auto data = mission::data_directory();
  const auto camera = close_range_camera(data);
  const TargetShape shape = TargetShape::load(data, "tango");
  engine::RandomStream stream(11, "circumstances");
  std::vector<Circumstances> all;
  for (int i = 0; i < count; ++i) all.push_back(draw_circumstances(camera, shape, stream));
  return all;
}

// The definition of the project: 17 mm behind 11.72 um pixels, 1450 of them.
TEST(Circumstances, CameraIsTheBinnedOne) {
  const auto camera = close_range_camera(mission::data_directory());
  EXPECT_NEAR(camera.focal_length_px(), 17.0 / 0.01172, 1e-9);
  EXPECT_EQ(camera.region, (twins::camera::Region{80, 50, 800, 500}));
  EXPECT_DOUBLE_EQ(camera.optics.principal_point_px[0], 479.5);
  EXPECT_DOUBLE_EQ(camera.optics.principal_point_px[1], 299.5);
  EXPECT_DOUBLE_EQ(camera.detector.full_well_electrons, 128000.0);
}

// Radiance of a matt white surface: albedo / pi of what falls on it; a pixel sees the square of its angle.
TEST(Circumstances, NominalExposureFillsSixTenthsWithWhite) {
  const auto camera = close_range_camera(mission::data_directory());
  const double sun = twins::camera::sun_photons(camera.zero_magnitude_photons, twins::camera::kAstronomicalUnit);
  const double pixel_rad = 0.01172 / 17.0;
  constexpr double kWhite = 0.78;
  const double electrons =
      sun * kWhite / M_PI * pixel_rad * pixel_rad * camera.electrons_per_photon_m2() * kNominalExposureS;
  EXPECT_NEAR(electrons / 128000.0, 0.6, 0.02);
}

TEST(Circumstances, StayWithinTheirBounds) {
  const auto camera = close_range_camera(mission::data_directory());
  const double earth_radius = std::asin(6378.137 / 7078.137);
  for (const Circumstances& c : draw(3000)) {
    const double range = c.centre_of_mass_camera.norm();
    EXPECT_GT(range, 4.0);
    EXPECT_LT(range, 15.0);
    EXPECT_NEAR((c.R_camera_body.transpose() * c.R_camera_body - fsw::Matrix3::Identity()).norm(), 0.0, 1e-12);
    const double phase = std::acos(-c.sun_camera.dot(c.centre_of_mass_camera.normalized()));
    EXPECT_NEAR(phase, c.phase_angle, 1e-6);
    EXPECT_LT(phase, 150.001 * kDegree);
    EXPECT_GT(std::acos(c.sun_camera.z()), 25.0 * kDegree);
    EXPECT_GT(std::acos(c.sun_camera.dot(c.nadir_camera)), earth_radius);
    EXPECT_GE(c.exposure, 0.5);
    EXPECT_LE(c.exposure, 2.0);
    EXPECT_GE(c.point_spread_sigma_px, 0.25);
    EXPECT_LE(c.point_spread_sigma_px, 0.9);
    const double radius_px = 0.722 * camera.focal_length_px() / range;  // Tango's farthest keypoint
    EXPECT_GT(c.region.side_px, 0.84 * 2.2 * radius_px);
    EXPECT_LT(c.region.side_px, 1.31 * 2.2 * radius_px);
  }
}

// Shares that the training of 54,000 crops relies on; 3000 draws tell a share to 0.03 at three deviations.
TEST(Circumstances, SharesAreThoseMeant) {
  const auto all = draw(3000);
  double behind = 0.0, penumbra = 0.0, earth = 0.0, phase = 0.0;
  for (const Circumstances& c : all) {
    behind += c.phase_angle > 130.0 * kDegree ? 1.0 : 0.0;
    penumbra += c.sunlit < 1.0 ? 1.0 : 0.0;
    earth += std::acos(c.nadir_camera.z()) < 76.3 * kDegree ? 1.0 : 0.0;
    phase += c.phase_angle;
  }
  const double n = static_cast<double>(all.size());
  EXPECT_NEAR(behind / n, 0.03, 0.01);
  EXPECT_NEAR(penumbra / n, 0.02, 0.01);
  EXPECT_NEAR(earth / n, 0.3, 0.03);
  EXPECT_NEAR(phase / n, 73.5 * kDegree, 6.0 * kDegree);
}

// Of attitudes uniform on SO(3) every body axis points everywhere: its mean is near zero, its square a third.
TEST(Circumstances, AttitudesAreUniform) {
  const auto all = draw(3000);
  fsw::Vector3 mean = fsw::Vector3::Zero(), square = fsw::Vector3::Zero();
  for (const Circumstances& c : all) {
    const fsw::Vector3 axis = c.R_camera_body.col(2);
    mean += axis / static_cast<double>(all.size());
    square += axis.cwiseAbs2() / static_cast<double>(all.size());
  }
  // Three deviations: 3 / sqrt(3 * 3000), and 3 * sqrt(4 / 45 / 3000).
  EXPECT_LT(accuracy::largest_entry(mean), 0.04);
  EXPECT_LT(accuracy::largest_entry(square - fsw::Vector3::Constant(1.0 / 3.0)), 0.02);
}

}  // namespace
}  // namespace vbar::training
