// What a camera's image should show, against OpenCV, exact fractions and orbits that can be worked out by hand.

#include "host_sim/sensors/camera/true_camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/constants.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "tests/support/figures.h"

namespace vbar::sensors {
namespace {

using fsw::Vector3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

twins::camera::CameraSettings tron() {
  twins::camera::CameraSettings settings;
  settings.optics.focal_length_mm = 17.0;
  settings.optics.distortion = {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243};
  return settings;
}

// Pixels by cv::projectPoints of OpenCV 4.6, printed with twelve decimals.
TEST(TrueCamera, PixelsThroughADistortingLensAreOpenCvs) {
  const struct {
    Vector3 point;
    Eigen::Vector2d pixel;
  } kCases[] = {{{0.0, 0.0, 5.0}, {959.5, 599.5}},
                {{1.2, -0.7, 6.0}, {1533.595087029928, 264.488354845376}},
                {{-2.0, 1.5, 8.0}, {246.672408766981, 1133.886817354879}},
                {{0.4, 1.1, 4.5}, {1213.924513494057, 1299.152424194362}},
                {{-1.5, -1.0, 7.0}, {345.482472984247, 190.054484034087}}};
  for (const auto& [point, pixel] : kCases)
    EXPECT_LT(accuracy::largest_entry(pixel_of(tron(), point).value() - pixel), 2e-12) << point.transpose();
}

TEST(TrueCamera, ThereIsNoPixelBehindTheCameraOrOfANan) {
  for (const Vector3& los : {Vector3(0.0, 0.0, -5.0), Vector3(1.0, 0.0, 0.0), Vector3(20.0, 0.0, 1.0),
                             Vector3(0.0, 0.0, 0.0), Vector3(kNan, 0.0, 5.0), Vector3(0.0, 0.0, kNan)})
    EXPECT_FALSE(pixel_of(tron(), los).has_value()) << los.transpose();
}

// The body is turned by 90 degrees about z: its x axis lies along ECI's y. The camera's boresight is the body's x axis.
TEST(TrueCamera, StandsAndLooksWhereItsMountSays) {
  CameraSensor camera;
  camera.position_body_m = {0.5, 0.0, 0.2};
  camera.q_camera_body = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitX(), Vector3::UnitZ());
  twins::SpacecraftTruth servicer{"servicer", {{7.0e6, 0.0, 0.0}, {0.0, 7.5e3, 0.0}}, truth::AttitudeState{}};
  servicer.attitude->q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(-M_PI / 2.0, Vector3::UnitZ()));
  const TrueCamera found = true_camera(camera, servicer);
  EXPECT_LT(accuracy::largest_entry(found.position_eci - Vector3(7.0e6, 0.5, 0.2)), 2e-9);
  EXPECT_LT(accuracy::largest_entry(found.q_camera_eci * Vector3::UnitY() - Vector3::UnitZ()), 1e-15);
  const twins::SpacecraftTruth other{"target", {{7.0e6, 10.5, 0.2}, {}}, std::nullopt};
  EXPECT_LT(accuracy::largest_entry(found.towards(other) - Vector3(0.0, 10.0, 0.0)), 2e-9);
}

constexpr double kLowerTriangle[21] = {10.62, 3.31,  6.46, 4.56,  1.58,  13.14, -4.85, -1.27, -2.52, 9.91, -3.49,
                                       -2.79, -1.13, 8.22, 14.83, -5.55, -0.31, -2.98, 1.89,  4.85,  9.0};

TEST(TrueCamera, LowerTrianglesAreByRows) {
  const fsw::Matrix6 matrix = symmetric(kLowerTriangle);
  EXPECT_EQ(matrix, matrix.transpose());
  EXPECT_EQ(matrix(0, 0), 10.62);
  EXPECT_EQ(matrix(2, 1), 1.58);
  EXPECT_EQ(matrix(3, 0), -4.85);
  EXPECT_EQ(matrix(5, 5), 9.0);
}

// By elimination in fractions (Python), without rounding.
TEST(TrueCamera, NormalisedSquareIsThatOfExactFractions) {
  fsw::Vector6 error;
  error << 0.5, -1.6, -0.8, -1.6, 1.3, -1.6;
  EXPECT_NEAR(normalised_square(error, symmetric(kLowerTriangle)).value(), 3.1065496103455743, 1e-13);
}

TEST(TrueCamera, NormalisedSquareNeedsAPositiveDefiniteCovariance) {
  const fsw::Vector6 error = fsw::Vector6::Ones();
  fsw::Matrix6 covariance = fsw::Matrix6::Identity();
  EXPECT_NEAR(normalised_square(error, covariance).value(), 6.0, 1e-14);
  covariance(4, 4) = 0.0;
  EXPECT_FALSE(normalised_square(error, covariance).has_value()) << "singular";
  covariance(4, 4) = -1.0;
  EXPECT_FALSE(normalised_square(error, covariance).has_value()) << "indefinite";
  EXPECT_FALSE(normalised_square(error, fsw::Matrix6::Zero()).has_value());
}

TEST(TrueCamera, NormalisedSquareRetainsANan) {
  const fsw::Matrix6 covariance = fsw::Matrix6::Identity();
  for (int k = 0; k < 6; ++k) {
    fsw::Vector6 error = fsw::Vector6::Zero();
    error(k) = kNan;
    EXPECT_TRUE(std::isnan(normalised_square(error, covariance).value())) << k;
    fsw::Matrix6 unknown = covariance;
    unknown(k, k) = kNan;
    EXPECT_TRUE(std::isnan(normalised_square(fsw::Vector6::Ones(), unknown).value_or(kNan))) << k;
  }
}

/// On a circular polar orbit, `angle` beyond the equator. Its ROE ahead of another: a times the angle along track.
fsw::orbit::CartesianState on_polar_orbit(double angle) {
  constexpr double kA = 7.0e6;
  const double speed = std::sqrt(fsw::orbit::kMu / kA);
  return {kA * Vector3(std::cos(angle), 0.0, std::sin(angle)), speed * Vector3(-std::sin(angle), 0.0, std::cos(angle))};
}

TEST(TrueCamera, NeesOfRoeIsThatOfTheTruth) {
  const double ahead_m = 700.0;
  double covariance[21] = {};
  for (int k = 0, place = 0; k < 6; place += ++k + 1) covariance[place] = 4.0;
  const double estimate[6] = {0.0, ahead_m + 4.0, 0.0, 2.0, 0.0, -2.0};  // off by two sigmas, one and one
  const auto nees = nees_of_roe(estimate, covariance, on_polar_orbit(0.3), on_polar_orbit(0.3 + ahead_m / 7.0e6));
  EXPECT_NEAR(nees.value(), 6.0, 1e-6);  // elements of 7000 km are rounded to 1e-9 m, a few times over
}

/// Elements are made dimensionless, and metres again, by the osculating semi-major axis of the same instant: with that
/// of another orbit, ten kilometres higher, the correct estimate of a target 7 km ahead would be in error by 10 m.
TEST(TrueCamera, NeesOfRoeOfTheTruthIsZeroOnAnyOrbit) {
  double covariance[21] = {};
  for (int k = 0, place = 0; k < 6; place += ++k + 1) covariance[place] = 1.0;
  const double raised = 1.0 + 10e3 / 7.0e6;
  const auto raise = [raised](fsw::orbit::CartesianState state) {
    state.position_eci *= raised;
    state.velocity_eci /= std::sqrt(raised);
    return state;
  };
  const double estimate[6] = {0.0, raised * 7000.0, 0.0, 0.0, 0.0, 0.0};
  const auto nees = nees_of_roe(estimate, covariance, raise(on_polar_orbit(0.3)), raise(on_polar_orbit(0.301)));
  EXPECT_NEAR(nees.value(), 0.0, 1e-10);
}

TEST(TrueCamera, NeesOfRoeNeedsOrbits) {
  double covariance[21] = {};
  for (int k = 0, place = 0; k < 6; place += ++k + 1) covariance[place] = 1.0;
  const double estimate[6] = {};
  fsw::orbit::CartesianState escaping = on_polar_orbit(0.0);
  escaping.velocity_eci *= 2.0;
  EXPECT_FALSE(nees_of_roe(estimate, covariance, on_polar_orbit(0.0), escaping).has_value());
  fsw::orbit::CartesianState unknown = on_polar_orbit(0.0);
  unknown.position_eci.y() = kNan;
  EXPECT_FALSE(nees_of_roe(estimate, covariance, unknown, on_polar_orbit(0.0)).has_value());
}

TEST(TrueCamera, ASpacecraftsRadiusHoldsTangoWithItsAntennas) {
  const auto data = mission::data_directory();
  const Vector3 centre_of_mass = mission::load_body(data / "bodies/tango.toml").centre_of_mass_m;
  accuracy::Largest farthest;
  for (const Vector3& keypoint : mission::load_keypoints(data / "bodies/tango.toml", 11))
    farthest.add((keypoint - centre_of_mass).norm());
  EXPECT_LE(farthest, kSpacecraftRadius_m);
  EXPECT_GT(farthest, kSpacecraftRadius_m - 0.01);
}

}  // namespace
}  // namespace vbar::sensors
