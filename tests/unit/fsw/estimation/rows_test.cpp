#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/estimation/batch.h"
#include "fsw/estimation/unscented.h"

namespace vbar::fsw::estimation {
namespace {

constexpr int kStates = 5;
constexpr int kMost = 6;
using SomeBatch = MeasurementBatch<kStates, kMost>;
using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Correlated states, four rows of correlated noise of which the third is not in use.
class BatchCase : public testing::Test {
 protected:
  BatchCase() {
    Eigen::Matrix<double, kStates, kStates> root;
    for (int k = 0; k < root.size(); ++k) root(k) = normal();
    covariance = root * root.transpose();
    estimate.transform_head<kStates>(Estimate<kStates>::Vector::LinSpaced(1.0, 5.0),
                                     Estimate<kStates>::Matrix::Identity(), covariance);
    batch.clear(4);
    Eigen::Matrix4d noise_root;
    for (int k = 0; k < 16; ++k) noise_root(k) = normal();
    batch.noise.topLeftCorner<4, 4>() = noise_root * noise_root.transpose();
    for (int k = 0; k < 4; ++k) {
      batch.residual(k) = normal();
      for (int i = 0; i < kStates; ++i) batch.sensitivity(i, k) = normal();
    }
    batch.is_used[2] = false;
  }
  double normal() { return normal_(random_); }

  /// The rows in use as matrices of extended precision.
  Wide h() const {
    Wide result(3, kStates);
    int r = 0;
    for (const int k : {0, 1, 3}) result.row(r++) = batch.sensitivity.col(k).transpose().cast<long double>();
    return result;
  }
  template <class Matrix>
  static Wide of_used(const Matrix& matrix) {
    Wide result(3, 3);
    int r = 0;
    for (const int i : {0, 1, 3}) {
      int c = 0;
      for (const int j : {0, 1, 3}) result(r, c++) = static_cast<long double>(matrix(i, j));
      ++r;
    }
    return result;
  }
  Wide residual() const {
    Wide result(3, 1);
    result << static_cast<long double>(batch.residual(0)), static_cast<long double>(batch.residual(1)),
        static_cast<long double>(batch.residual(3));
    return result;
  }

  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  Eigen::Matrix<double, kStates, kStates> covariance;
  Estimate<kStates> estimate;
  SomeBatch batch;
};

TEST_F(BatchCase, UpdateIsKalmans) {
  const Wide p = covariance.cast<long double>();
  const Wide s = h() * p * h().transpose() + of_used(batch.noise);
  const Wide gain = p * h().transpose() * s.inverse();
  const Wide mean = estimate.mean().cast<long double>() + gain * residual();
  const Wide rest = p - gain * h() * p;
  const Wide postfit = residual() - h() * gain * residual();
  const double unused = batch.residual(2) - batch.sensitivity.col(2).dot((gain * residual()).cast<double>().col(0));
  ASSERT_TRUE(update(estimate, batch));
  for (int i = 0; i < kStates; ++i) {
    EXPECT_NEAR(estimate.mean(i), static_cast<double>(mean(i)), 1e-12);
    for (int j = 0; j < kStates; ++j) EXPECT_NEAR(estimate.covariance(i, j), static_cast<double>(rest(i, j)), 1e-12);
  }
  int r = 0;
  for (const int k : {0, 1, 3}) EXPECT_NEAR(batch.residual(k), static_cast<double>(postfit(r++)), 1e-12) << k;
  EXPECT_NEAR(batch.residual(2), unused, 1e-12);
}

TEST_F(BatchCase, NisAreThoseOfTheInverse) {
  predict_innovations(estimate, batch);
  const Wide s = h() * covariance.cast<long double>() * h().transpose() + of_used(batch.noise);
  const Wide expected = residual().transpose() * s.inverse() * residual();
  EXPECT_NEAR(joint_nis(batch), static_cast<double>(expected(0)), 1e-12 * static_cast<double>(expected(0)));
  const Eigen::Matrix2d pair = batch.innovation.topLeftCorner<2, 2>();
  const Eigen::Vector2d of_pair = batch.residual.head<2>();
  EXPECT_NEAR(group_nis(batch, 0, 2), of_pair.dot(pair.inverse() * of_pair), 1e-10);
  EXPECT_NEAR(group_nis(batch, 3, 1), batch.residual(3) * batch.residual(3) / batch.innovation(3, 3), 1e-14);
}

TEST_F(BatchCase, ANoiseThatIsNoneChangesNothing) {
  batch.noise(1, 1) = -1.0;
  const auto mean = estimate.mean();
  EXPECT_FALSE(update(estimate, batch));
  EXPECT_EQ(estimate.mean(), mean);
  batch.noise(1, 1) = NAN;
  EXPECT_FALSE(update(estimate, batch));
  EXPECT_EQ(estimate.mean(), mean);
  batch.innovation(0, 0) = NAN;
  EXPECT_EQ(group_nis(batch, 0, 2), kNoGate);
  batch.innovation.setZero();
  EXPECT_EQ(joint_nis(batch), kNoGate);
}

/// A component of variance zero is not sampled, and the others as if it did not exist.
TEST(UnscentedTransform, InactiveComponentsAreNotSampled) {
  UnscentedTransform<3> transform;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) = 4.0;
  covariance(2, 2) = 9.0;
  covariance(0, 2) = covariance(2, 0) = 3.0;
  ASSERT_EQ(transform.start({1.0, 2.0, 3.0}, covariance), Status::kOk);
  std::array<Eigen::Matrix<double, 1, 1>, UnscentedTransform<3>::kPoints> values;
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(transform.point(k)(1), 2.0);
    EXPECT_EQ(transform.is_mean(k), k == 2 || k == 5) << k;
    values[k](0) = 5.0 * transform.point(k)(0) + 7.0 * transform.point(k)(1) - 2.0 * transform.point(k)(2);
  }
  const auto regression = transform.regress<1>(values);
  EXPECT_NEAR(regression.mean(0), 5.0 + 14.0 - 6.0, 1e-12);
  EXPECT_NEAR(regression.jacobian(0), 5.0, 1e-12);
  EXPECT_EQ(regression.jacobian(1), 0.0);
  EXPECT_NEAR(regression.jacobian(2), -2.0, 1e-12);
  EXPECT_NEAR(regression.nonlinearity(0), 0.0, 1e-20);
}

}  // namespace
}  // namespace vbar::fsw::estimation
