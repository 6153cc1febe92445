// Jacobi's eigenvalues and eigenvectors of small symmetric matrices.

#include "fsw/math/symmetric_eigen.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::fsw::math {
namespace {

template <int N>
void expect_decomposes(const Eigen::Matrix<double, N, N>& a) {
  using Square = Eigen::Matrix<double, N, N>;
  const Result<SymmetricEigen<N>> result = symmetric_eigen<N>(a);
  ASSERT_TRUE(result.ok());
  const auto& [values, vectors] = result.value();
  const Square rebuilt = vectors * values.asDiagonal() * vectors.transpose();
  // A few roundings a rotation, 6 sweeps of at most 15 rotations.
  EXPECT_LT(accuracy::largest_entry(rebuilt - a), 1e-14 * accuracy::largest_entry(a));
  EXPECT_LT(accuracy::largest_entry(vectors.transpose() * vectors - Square::Identity()), 1e-14);
  for (int k = 1; k < N; ++k) EXPECT_LE(values(k - 1), values(k));
}

template <int N>
void expect_decomposes_random() {
  std::mt19937_64 generator(static_cast<unsigned>(N));
  std::normal_distribution<double> normal;
  for (int k = 0; k < 500; ++k) {
    Eigen::Matrix<double, N, N> a;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) a(i, j) = normal(generator);
    }
    expect_decomposes<N>(a + a.transpose());
  }
}

TEST(SymmetricEigen, RebuildsTheMatrix) {
  expect_decomposes_random<1>();
  expect_decomposes_random<2>();
  expect_decomposes_random<3>();
  expect_decomposes_random<6>();
}

TEST(SymmetricEigen, KnowsTextbookSpectra) {
  Matrix3 a;  // second difference with fixed ends: 2 - sqrt 2, 2, 2 + sqrt 2
  a << 2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 2.0;
  const Vector3 values = symmetric_eigen<3>(a).value().values;
  EXPECT_NEAR(values(0), 2.0 - std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(values(1), 2.0, 1e-15);
  EXPECT_NEAR(values(2), 2.0 + std::sqrt(2.0), 1e-15);
}

TEST(SymmetricEigen, TakesDegenerateAndWidelyScaledMatrices) {
  expect_decomposes<3>(Matrix3::Identity());
  expect_decomposes<3>(Matrix3::Zero() + 1e-300 * Matrix3::Identity());
  expect_decomposes<3>(Matrix3::Ones());  // eigenvalues 0, 0, 3
  Matrix3 wide;
  wide << 1e12, 1e5, 1.0, 1e5, 1.0, 1e-6, 1.0, 1e-6, 1e-6;
  expect_decomposes<3>(wide);
  EXPECT_TRUE(symmetric_eigen<3>(Matrix3::Zero()).ok());
}

TEST(SymmetricEigen, ReadsTheUpperTriangleOnly) {
  Matrix3 a;
  a << 2.0, -1.0, 0.0, 99.0, 2.0, -1.0, 99.0, 99.0, 2.0;
  EXPECT_NEAR(symmetric_eigen<3>(a).value().values(1), 2.0, 1e-15);
}

TEST(SymmetricEigen, RefusesWhatIsNotFinite) {
  Matrix3 a = Matrix3::Identity();
  a(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(symmetric_eigen<3>(a).status(), Status::kNotFinite);
  a(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(symmetric_eigen<3>(a).status(), Status::kNotFinite);
}

}  // namespace
}  // namespace vbar::fsw::math
