// What a camera's image should show, against OpenCV, exact fractions and orbits that can be worked out by hand.

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_truth.h"
#include "host_sim/sensors/camera/image_gallery.h"
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

// A testbed's image beside the digital twin's: where the target lies relative to the stars, and what a picture of the
// difference shows.

namespace {

constexpr int kWidth = 120, kHeight = 90, kX = 710, kY = 200;

class Images : public testing::Test {
 protected:
  Images() : testbed_(kWidth * kHeight, 0.0), twin_(kWidth * kHeight, 0.0) {}

  /// A Gaussian of 0.8 px at a place of the detector, and what the flight software calls it.
  static void add_star(std::vector<double>& light, double x_px, double y_px, double flux) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double dx = x + kX - x_px, dy = y + kY - y_px;
        light[static_cast<std::size_t>(y * kWidth + x)] +=
            flux / (2.0 * M_PI * 0.64) * std::exp(-0.5 * (dx * dx + dy * dy) / 0.64);
      }
  }
  void add(std::int8_t kind, double x_px, double y_px, const Eigen::Vector2d& shift_px, double flux = 12000.0) {
    add_star(twin_, x_px, y_px, flux);
    add_star(testbed_, x_px + shift_px.x(), y_px + shift_px.y(), flux);
    const auto k = static_cast<std::size_t>(objects_.count++);
    objects_.kind[k] = kind;
    objects_.x_px[k] = static_cast<float>(x_px + shift_px.x());
    objects_.y_px[k] = static_cast<float>(y_px + shift_px.y());
  }
  static std::vector<std::uint16_t> dn(const std::vector<double>& light) {
    std::vector<std::uint16_t> dn;
    for (const double value : light) dn.push_back(static_cast<std::uint16_t>(std::min(64.5 + value, 4095.0)));
    return dn;
  }
  ImagePair pair() {
    testbed_dn_ = dn(testbed_);
    twin_dn_ = dn(twin_);
    return {kWidth, kHeight, kX, kY, testbed_dn_, twin_dn_};
  }

  std::vector<double> testbed_, twin_;
  std::vector<std::uint16_t> testbed_dn_, twin_dn_;
  telemetry_objects objects_{};
};

using Kind = telemetry_objects;

// A shift of all alike is the attitude's, not the bearing's.
TEST_F(Images, TargetIsMeasuredRelativeToTheStars) {
  const Eigen::Vector2d all(0.3, -0.2);
  add(Kind::kKindStar, kX + 20, kY + 20, all);
  add(Kind::kKindStar, kX + 90.4, kY + 30.3, all);
  add(Kind::kKindStar, kX + 60.7, kY + 70.1, all);
  add(Kind::kKindTarget, kX + 40.2, kY + 50.6, all + Eigen::Vector2d(0.1, 0.05));
  const auto shift = target_shift_px(pair(), objects_);
  ASSERT_TRUE(shift);
  // Numbers are rounded to whole DN of some thousand: 0.01 px.
  EXPECT_NEAR(shift->x(), 0.1, 0.01);
  EXPECT_NEAR(shift->y(), 0.05, 0.01);

  ImageRow row;
  row.bearing_error_x_arcsec = 5.0;
  row.bearing_error_y_arcsec = -1.0;
  const double focal_length_px = 1.0 / (10.0 * fsw::math::kArcsecond);  // 10 arcsec a pixel
  EXPECT_THAT(difference_text(pair(), row, &objects_, focal_length_px),
              testing::HasSubstr("bearing error 5.0, -1.0 arcsec, in the image of the twin 4.0, -1.5 arcsec"));
}

TEST_F(Images, ShiftNeedsTargetAndStars) {
  add(Kind::kKindTarget, kX + 40, kY + 50, {0.0, 0.0});
  EXPECT_FALSE(target_shift_px(pair(), objects_));
  add(Kind::kKindStar, kX + 1, kY + 1, {0.0, 0.0});
  EXPECT_FALSE(target_shift_px(pair(), objects_)) << "at the edge";
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  EXPECT_TRUE(target_shift_px(pair(), objects_));
  objects_.x_px[0] = NAN;
  EXPECT_FALSE(target_shift_px(pair(), objects_)) << "not a place";
  EXPECT_THAT(difference_text(pair(), {}, nullptr, 6000.0), testing::HasSubstr("noise"));
}

TEST_F(Images, MissingPixelsAreNotCompared) {
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  add(Kind::kKindTarget, kX + 40, kY + 50, {0.0, 0.0});
  ImagePair both = pair();
  std::fill(testbed_dn_.begin(), testbed_dn_.begin() + 55 * kWidth, std::uint16_t{0xFFFF});
  both.testbed = testbed_dn_;
  EXPECT_FALSE(target_shift_px(both, objects_));
  EXPECT_EQ(difference_text(both, {}, &objects_, 6000.0), "median 0.0 DN, noise 0.5 DN");
}

TEST_F(Images, EqualImagesHaveABlackDifference) {
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  const std::vector<std::uint8_t> black = difference_png(pair());
  add_star(testbed_, kX + 70, kY + 70, 5000.0);
  EXPECT_NE(difference_png(pair()), black);
  EXPECT_EQ(difference_text(pair(), {}, nullptr, 6000.0), "median 0.0 DN, noise 0.5 DN");
}

}  // namespace

}  // namespace vbar::sensors
