// Mean and scatter of poses.

#include "hil_drivers/tron/vicon/object_average.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "fsw/core/types.h"

namespace vbar::tron::vicon {
namespace {

using fsw::Vector3;

Eigen::Isometry3d pose(const Vector3& translation, const Vector3& axis, double angle) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

TEST(ObjectAverage, OfNoPosesIsSilent) {
  EXPECT_EQ(average_of({}).state, ObjectState::kSilent);
  EXPECT_EQ(average_of({}).frames, 0);
}

// About one axis the mean rotation is the mean angle, also across 180 deg, where angles jump.
TEST(ObjectAverage, AboutOneAxisIsTheMeanAngle) {
  const Vector3 axis(1.0, 2.0, -0.5);
  std::vector<Eigen::Isometry3d> poses;
  for (const double angle : {3.0, 3.1, 3.2, 3.5}) poses.push_back(pose({angle, 0.0, 1.0}, axis, angle));
  const ObjectAverage average = average_of(poses);
  EXPECT_EQ(average.state, ObjectState::kTracked);
  EXPECT_EQ(average.frames, 4);
  EXPECT_TRUE(average.T_V_object.isApprox(pose({3.2, 0.0, 1.0}, axis, 3.2), 1e-14));
  // Squares about the mean: 0.04 + 0.01 + 0 + 0.09; three degrees of freedom, three axes.
  EXPECT_NEAR(average.translation_scatter_m, std::sqrt(0.14 / 9.0), 1e-14);
  EXPECT_NEAR(average.rotation_scatter_rad, std::sqrt(0.14 / 9.0), 1e-14);
}

TEST(ObjectAverage, OfOnePoseIsThatPose) {
  const auto one = pose({1.0, 2.0, 3.0}, {0.0, 1.0, 1.0}, 2.5);
  const ObjectAverage average = average_of({one, one, one});
  EXPECT_TRUE(average.T_V_object.isApprox(one, 1e-15));
  EXPECT_LT(average.rotation_scatter_rad, 1e-7);  // angle of a rotation matrix near the identity: root of rounding
}

// Normal errors: the mean of 400 is 20 times closer than one, and the scatter is that of one, within 10 %.
TEST(ObjectAverage, ScatterIsThatOfOneFrame) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto truth = pose({0.5, -2.0, 1.0}, {1.0, 1.0, 1.0}, 1.0);
  const double sigma_m = 5e-5, sigma_rad = 3.5e-4;
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 400; ++k) {
    const Vector3 turn = sigma_rad * Vector3(normal(random), normal(random), normal(random));
    Eigen::Isometry3d noisy = truth;
    noisy.linear() = truth.linear() * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    noisy.translation() += sigma_m * Vector3(normal(random), normal(random), normal(random));
    poses.push_back(noisy);
  }
  const ObjectAverage average = average_of(poses);
  EXPECT_NEAR(average.translation_scatter_m, sigma_m, 0.1 * sigma_m);
  EXPECT_NEAR(average.rotation_scatter_rad, sigma_rad, 0.1 * sigma_rad);
  EXPECT_LT((average.T_V_object.translation() - truth.translation()).norm(), 4.0 * std::sqrt(3.0) * sigma_m / 20.0);
  EXPECT_LT(Eigen::AngleAxisd(average.T_V_object.linear().transpose() * truth.linear()).angle(),
            4.0 * std::sqrt(3.0) * sigma_rad / 20.0);
}

}  // namespace
}  // namespace vbar::tron::vicon
