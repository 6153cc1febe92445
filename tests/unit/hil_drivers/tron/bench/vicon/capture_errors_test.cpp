// Sizes of the hidden errors over benches, and what they depend on.

#include "hil_drivers/tron/bench/vicon/capture_errors.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Isometry3d pose(double x, double y, double z, double angle = 0.3) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Vector3(x, y, z);
  return pose;
}

double angle_of(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle();
}

TEST(CaptureErrors, OfABenchWithoutErrorsAreNone) {
  const CaptureErrors errors(CaptureErrorSizes::none(), 1);
  const auto truth = pose(6.5, 0.1, 1.4);
  for (const auto object : {CaptureObject::kCamera, CaptureObject::kTarget})
    EXPECT_TRUE(errors.stated(object, truth, 17).isApprox(truth, 1e-15));
}

TEST(CaptureErrors, AreFunctionsOfSeedPoseAndFrame) {
  const CaptureErrors errors({}, 5), same({}, 5), other({}, 6);
  const auto truth = pose(3.0, 0.0, 2.0);
  const auto stated = errors.stated(CaptureObject::kCamera, truth, 8);
  (void)same.stated(CaptureObject::kTarget, truth, 3);
  EXPECT_EQ(same.stated(CaptureObject::kCamera, truth, 8).matrix(), stated.matrix());
  EXPECT_NE(errors.stated(CaptureObject::kCamera, truth, 9).matrix(), stated.matrix());
  EXPECT_GT((other.stated(CaptureObject::kCamera, truth, 8).matrix() - stated.matrix()).norm(), 1e-3);
}

// Of 500 benches; the standard deviation of a standard deviation of 1500 numbers is 2 %.
TEST(CaptureErrors, HaveTheSizesAsked) {
  CaptureErrorSizes frame = CaptureErrorSizes::none(), bias = frame, view = frame, noise = frame;
  frame.frame_rotation_deg = 2.0;
  frame.frame_translation_mm = 50.0;
  bias.bias_mm = 0.3;
  view.view_rotation_deg = 0.09;
  noise.noise_mm = 0.05;
  noise.noise_deg = 0.02;
  const auto truth = pose(4.0, 0.5, 1.0);
  double frame_m2 = 0, frame_rad2 = 0, bias_m2 = 0, view_rad2 = 0, noise_m2 = 0, noise_rad2 = 0;
  constexpr int kBenches = 500;
  for (std::uint64_t seed = 1; seed <= kBenches; ++seed) {
    const CaptureErrors offset(frame, seed);
    frame_m2 += offset.T_V_L().translation().squaredNorm();
    frame_rad2 += std::pow(angle_of(offset.T_V_L().linear()), 2);
    const auto error = [&](const CaptureErrorSizes& sizes) -> Eigen::Isometry3d {
      return truth.inverse() * CaptureErrors(sizes, seed).stated(CaptureObject::kTarget, truth, seed);
    };
    bias_m2 += error(bias).translation().squaredNorm();
    view_rad2 += std::pow(angle_of(error(view).linear()), 2);
    noise_m2 += error(noise).translation().squaredNorm();
    noise_rad2 += std::pow(angle_of(error(noise).linear()), 2);
  }
  const auto sigma = [](double sum) { return std::sqrt(sum / (3.0 * kBenches)); };
  EXPECT_NEAR(sigma(frame_m2), 50e-3, 0.1 * 50e-3);
  EXPECT_NEAR(sigma(frame_rad2), 2.0 * kDegree, 0.1 * 2.0 * kDegree);
  EXPECT_NEAR(sigma(bias_m2), 0.3e-3, 0.1 * 0.3e-3);
  EXPECT_NEAR(sigma(view_rad2), 0.09 * kDegree, 0.1 * 0.09 * kDegree);
  EXPECT_NEAR(sigma(noise_m2), 0.05e-3, 0.1 * 0.05e-3);
  EXPECT_NEAR(sigma(noise_rad2), 0.02 * kDegree, 0.1 * 0.02 * kDegree);
}

// Covariance of a Gaussian field: exp(-d^2/2) at d correlation lengths: 0.995, 0.607, 0.011 at 0.1, 1, 3.
TEST(CaptureErrors, BiasVariesOverAMetre) {
  CaptureErrorSizes sizes = CaptureErrorSizes::none();
  sizes.bias_mm = 0.3;
  double same = 0, near = 0, at_length = 0, far = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const CaptureErrors errors(sizes, seed);
    const auto bias = [&](double x) -> Vector3 {
      return errors.stated(CaptureObject::kCamera, pose(x, 0, 1), 0).translation() - Vector3(x, 0, 1);
    };
    same += bias(4).squaredNorm();
    near += bias(4).dot(bias(4.1));
    at_length += bias(4).dot(bias(5));
    far += bias(4).dot(bias(7));
  }
  EXPECT_NEAR(near / same, 0.995, 0.01);
  EXPECT_NEAR(at_length / same, 0.607, 0.1);
  EXPECT_NEAR(far / same, 0.011, 0.1);
}

TEST(CaptureErrors, AnObjectHasTheSameErrorWheneverItIsAtAPose) {
  CaptureErrorSizes sizes;
  sizes.noise_mm = sizes.noise_deg = 0.0;
  const CaptureErrors errors(sizes, 3);
  const auto here = pose(4.0, 0.0, 1.0), turned = pose(4.0, 0.0, 1.0, 1.5);
  const auto rotation_error = [&](const Eigen::Isometry3d& truth, CaptureObject object) -> Eigen::Matrix3d {
    const Eigen::Isometry3d without = errors.T_V_L() * truth * errors.T_body_object(object);
    return without.linear().transpose() * errors.stated(object, truth, 1).linear();
  };
  EXPECT_EQ(errors.stated(CaptureObject::kCamera, here, 1).matrix(),
            errors.stated(CaptureObject::kCamera, here, 900).matrix());
  EXPECT_GT(angle_of(rotation_error(here, CaptureObject::kCamera).transpose() *
                     rotation_error(turned, CaptureObject::kCamera)),
            0.01 * kDegree);
  EXPECT_GT(
      angle_of(rotation_error(here, CaptureObject::kCamera).transpose() * rotation_error(here, CaptureObject::kTarget)),
      0.01 * kDegree);
}

}  // namespace
}  // namespace vbar::tron::bench
