// Scatter of a source about its model.

#include "hil_drivers/tron/calibrate/fit/scatter.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The pose with camera and target turned and moved at random, as the comment of Scatter says.
Isometry3d disturbed(const Isometry3d& T_C_T, const Scatter& scatter, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&](double rotation, double place) {
    Isometry3d pose = Isometry3d::Identity();
    const Eigen::Vector3d vector = rotation * Eigen::Vector3d(normal(random), normal(random), normal(random));
    pose.linear() = Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
    pose.translation() = place * Eigen::Vector3d(normal(random), normal(random), normal(random));
    return pose;
  };
  return draw(scatter.camera_rad, scatter.place_m).inverse() * T_C_T * draw(scatter.target_rad, scatter.place_m);
}

Isometry3d pose(double range_m) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.6, 0.8, 0.0)).toRotationMatrix();
  T.translation() << 0.2, -0.3, range_m;
  return T;
}

TEST(Scatter, CovarianceIsThatOfManyDraws) {
  std::mt19937_64 random(1);
  const Scatter scatter{1e-3, 2e-3, 1e-3};
  const Isometry3d T = pose(3.0);
  Matrix6 sum = Matrix6::Zero();
  constexpr int kDraws = 40000;
  for (int k = 0; k < kDraws; ++k) {
    const Vector6 difference = pose_difference(T, disturbed(T, scatter, random));
    sum += difference * difference.transpose() / kDraws;
  }
  // A second moment of 40,000 draws scatters by 0.7 % of the product of both deviations; six of them.
  const Matrix6 expected = scatter_covariance(scatter, T);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(sum(i, j), expected(i, j), 0.05 * std::sqrt(expected(i, i) * expected(j, j))) << i << " " << j;
}

TEST(Scatter, IsFoundAgainWithKnownNoiseTakenOut) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  const Scatter scatter{1.6e-3, 0.9e-3, 1e-3};
  std::vector<ScatterSample> samples;
  for (int k = 0; k < 800; ++k) {
    const Isometry3d T = pose(1.2 + 4.4 * k / 800.0);
    Matrix6 known = Matrix6::Zero();
    known.diagonal() << 1e-6, 1e-6, 1e-7, 1e-7, 1e-7, 4e-6;
    Vector6 noise;
    for (int i = 0; i < 6; ++i) noise[i] = std::sqrt(known(i, i)) * normal(random);
    samples.push_back({T, Vector6(pose_difference(T, disturbed(T, scatter, random)) + noise), known});
  }
  const Scatter found = estimate_scatter(samples, {5e-4, 5e-4, 5e-4});
  // Student's t with five degrees of freedom takes the core: up to 20 % below a normal distribution's deviation.
  EXPECT_NEAR(found.camera_rad, scatter.camera_rad, 0.25 * scatter.camera_rad);
  EXPECT_NEAR(found.target_rad, scatter.target_rad, 0.25 * scatter.target_rad);
  EXPECT_NEAR(found.place_m, scatter.place_m, 0.25 * scatter.place_m);
}

TEST(Scatter, DifferenceLeadsFromOneToTheOther) {
  const Isometry3d a = pose(2.0), b = pose(3.0);
  const Vector6 difference = pose_difference(a, b);
  EXPECT_LT((difference - (Vector6() << 0.0, 0.0, 0.0, 0.0, 0.0, 1.0).finished()).norm(), 1e-12);
}

}  // namespace
}  // namespace vbar::tron::calibrate
