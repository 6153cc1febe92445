#include "fsw/estimation/unscented.h"

#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace vbar::fsw::filter {
namespace {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Matrix2 = Eigen::Matrix<double, 2, 2>;

// A range of 1 +- 0.02 and a bearing of 90 +- 15 degrees, to Cartesian: the standard example of the transform.
struct PolarToCartesian {
  Vector2 mean{1.0, M_PI / 2.0};
  Matrix2 covariance = Vector2(0.02 * 0.02, std::pow(15.0 * M_PI / 180.0, 2)).asDiagonal();

  estimation::UnscentedTransform<2>::Regression<2> regression(const estimation::UnscentedParameters& parameters) const {
    estimation::UnscentedTransform<2> transform;
    EXPECT_EQ(transform.start(mean, covariance, parameters), Status::kOk);
    std::array<Vector2, 5> values;
    for (std::size_t k = 0; k < 5; ++k) {
      const Vector2 p = transform.point(k);
      values[k] = p(0) * Vector2(std::cos(p(1)), std::sin(p(1)));
    }
    return transform.regress<2>(values);
  }

  /// The transform's sums over the five points written out, with c = alpha^2 (2 + kappa) and the points sqrt(c) sigma
  /// from the mean: two points lie on the y axis, two are turned by x to both sides (Julier and Uhlmann 2004, section
  /// III).
  struct Expected {
    explicit Expected(const estimation::UnscentedParameters& p) {
      const double c = p.alpha * p.alpha * (2.0 + p.kappa), x = std::sqrt(c) * 15.0 * M_PI / 180.0;
      const double drop = 2.0 * std::pow(std::sin(x / 2.0), 2);  // 1 - cos x
      const double below = drop / c;                             // 1 - mean
      mean_y = 1.0 - below;
      variance_x = std::pow(std::sin(x), 2) / c;
      variance_y = 0.02 * 0.02 + below * below * ((c - 2.0) / c + 1.0 - p.alpha * p.alpha + p.beta + 1.0 / c) +
                   (below - drop) * (below - drop) / c;
    }
    double mean_y, variance_x, variance_y;
  };

  Vector2 variances(const estimation::UnscentedTransform<2>::Regression<2>& r) const {
    return (r.jacobian * covariance * r.jacobian.transpose() + r.nonlinearity).diagonal();
  }
};

TEST(Unscented, PolarToCartesianWithSmallSpread) {
  const PolarToCartesian example;
  const estimation::UnscentedParameters parameters{.alpha = 1e-3, .beta = 2.0, .kappa = 0.0};
  const auto r = example.regression(parameters);
  const PolarToCartesian::Expected expected(parameters);
  // alpha = 1e-3 costs six digits by its weights of 1e6.
  EXPECT_NEAR(r.mean(0), 0.0, 1e-8);
  EXPECT_NEAR(r.mean(1), expected.mean_y, 1e-8);
  EXPECT_NEAR(example.variances(r)(0), expected.variance_x, 1e-8);
  EXPECT_NEAR(example.variances(r)(1), expected.variance_y, 1e-8);
}

TEST(Unscented, PolarToCartesianWithWideSpread) {
  const PolarToCartesian example;
  const estimation::UnscentedParameters parameters{.alpha = 1.0, .beta = 0.0, .kappa = 1.0};
  const auto r = example.regression(parameters);
  const PolarToCartesian::Expected expected(parameters);
  EXPECT_NEAR(r.mean(1), expected.mean_y, 1e-15);
  EXPECT_NEAR(r.mean(1), std::exp(-0.5 * std::pow(15.0 * M_PI / 180.0, 2)), 3e-6);  // E[cos] of a normal angle
  EXPECT_NEAR(example.variances(r)(0), expected.variance_x, 1e-15);
  EXPECT_NEAR(example.variances(r)(1), expected.variance_y, 1e-15);
}

TEST(Unscented, LinearFunctionIsExact) {
  Eigen::Matrix<double, 4, 4> root;
  root << 2, 0, 0, 0, -1, 3, 0, 0, 0.5, 0.25, 1e-3, 0, 4, -2, 1e-3, 5;
  const Eigen::Matrix<double, 4, 4> covariance = root * root.transpose();
  const Eigen::Matrix<double, 4, 1> mean(7e6, -3.0, 1e-2, 40.0);
  Eigen::Matrix<double, 3, 4> a;
  a << 1, 2, 3, 4, 0, 1, 0, -1, 5, 0, 0.5, 0;
  estimation::UnscentedTransform<4> transform;
  ASSERT_EQ(transform.start(mean, covariance), Status::kOk);
  std::array<Eigen::Matrix<double, 3, 1>, 9> values;
  for (std::size_t k = 0; k < 9; ++k) values[k] = a * transform.point(k);
  const auto r = transform.regress<3>(values);
  // Differences of numbers near 7e6 keep 1e-9; the smallest factor divided by is 1e-3.
  EXPECT_LT((r.mean - a * mean).norm(), 2e-8);
  EXPECT_LT((r.jacobian - a).norm(), 1e-5);
  EXPECT_LT(r.nonlinearity.norm(), 1e-15);
}

TEST(Unscented, SecondMomentOfASquare) {
  // y = x^2 of a standard normal: mean 1, variance 2, slope 0. kappa = 2 (n + kappa = 3) matches the fourth moment.
  estimation::UnscentedTransform<1> transform;
  ASSERT_EQ(transform.start(Eigen::Matrix<double, 1, 1>(0.0), Eigen::Matrix<double, 1, 1>(1.0),
                            {.alpha = 1.0, .beta = 0.0, .kappa = 2.0}),
            Status::kOk);
  std::array<Eigen::Matrix<double, 1, 1>, 3> values;
  for (std::size_t k = 0; k < 3; ++k) values[k] = transform.point(k).cwiseAbs2();
  const auto r = transform.regress<1>(values);
  EXPECT_NEAR(r.mean(0), 1.0, 1e-15);
  EXPECT_NEAR(r.jacobian(0), 0.0, 1e-15);
  EXPECT_NEAR(r.nonlinearity(0), 2.0, 1e-14);
}

TEST(Unscented, RefusesWhatIsNoCovariance) {
  estimation::UnscentedTransform<2> transform;
  Matrix2 bad;
  bad << 1.0, 2.0, 2.0, 1.0;
  EXPECT_EQ(transform.start(Vector2::Zero(), bad), Status::kSingular);
  bad << 1.0, NAN, NAN, 1.0;
  EXPECT_EQ(transform.start(Vector2::Zero(), bad), Status::kSingular);
  bad << 0.0, 0.1, 0.1, 1.0;  // correlated without a variance
  EXPECT_EQ(transform.start(Vector2::Zero(), bad), Status::kSingular);
  bad << 1.0, 0.1, 0.1, 0.0;
  EXPECT_EQ(transform.start(Vector2::Zero(), bad), Status::kSingular);
}

}  // namespace
}  // namespace vbar::fsw::filter
