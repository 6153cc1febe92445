#include "fsw/estimation/estimate.h"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/estimation/measurement_batch.h"
#include "fsw/estimation/state_layout.h"
#include "fsw/estimation/unscented.h"
#include "tests/support/allocation_counter.h"

namespace vbar::fsw::filter {

namespace {

struct Orbit {
  static constexpr int kSize = 6;
};
struct Clock {
  static constexpr int kSize = 2;
};
struct Ambiguities {
  static constexpr int kSize = 40;
};

TEST(Layout, BlocksStandOneAfterTheOther) {
  using State = estimation::Layout<Orbit, Clock, Ambiguities>;
  static_assert(State::kSize == 48);
  static_assert(State::offset<Orbit>() == 0 && State::offset<Clock>() == 6 && State::offset<Ambiguities>() == 8);
}

/// A dense Kalman filter by the textbook, in the information form: another way to the same numbers.
template <int N>
struct InformationFilter {
  Eigen::Matrix<double, N, N> information;
  Eigen::Matrix<double, N, 1> vector;
  void add(const Eigen::Matrix<double, N, 1>& h, double z, double variance) {
    information += h * h.transpose() / variance;
    vector += h * z / variance;
  }
};

TEST(Estimate, ScalarUpdatesAreTheLeastSquaresSolution) {
  constexpr int kN = 8;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  estimation::Estimate<kN> estimate;
  InformationFilter<kN> reference{Eigen::Matrix<double, kN, kN>::Zero(), Eigen::Matrix<double, kN, 1>::Zero()};
  for (int i = 0; i < kN; ++i) {
    estimate.reset(i, i, 4.0);
    reference.add(Eigen::Matrix<double, kN, 1>::Unit(i), i, 4.0);
  }
  for (int k = 0; k < 30; ++k) {
    Eigen::Matrix<double, kN, 1> h;
    for (int i = 0; i < kN; ++i) h(i) = normal(random);
    const double z = normal(random);
    const estimation::Innovation foreseen = estimate.predict(h, z - h.dot(estimate.mean()), 0.25);
    const estimation::Innovation seen = estimate.update(h, z - h.dot(estimate.mean()), 0.25, estimation::kNoGate);
    EXPECT_TRUE(seen.accepted);
    EXPECT_DOUBLE_EQ(foreseen.variance, seen.variance);
    reference.add(h, z, 0.25);
  }
  const Eigen::Matrix<double, kN, kN> covariance = reference.information.inverse();
  const Eigen::Matrix<double, kN, 1> mean = covariance * reference.vector;
  for (int i = 0; i < kN; ++i) {
    EXPECT_NEAR(estimate.mean(i), mean(i), 1e-12);  // 30 updates of numbers near 1
    for (int j = 0; j < kN; ++j) EXPECT_NEAR(estimate.covariance(i, j), covariance(i, j), 1e-13);
  }
}

// Components become active and inactive in any order, the last ones too: the operations then run over others, with the
// results of the textbook's dense equations.
TEST(Estimate, ActivationInAnyOrderIsTheDenseFilter) {
  constexpr int kN = 9;
  using Matrix = Eigen::Matrix<double, kN, kN>;
  using Vector = Eigen::Matrix<double, kN, 1>;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> component(0, kN - 1);
  estimation::Estimate<kN> estimate;
  Vector mean = Vector::Zero();
  Matrix covariance = Matrix::Zero();
  for (int step = 0; step < 400; ++step) {
    const int i = component(random);
    const auto scaled = [&](double factor) {
      Matrix scaling = Matrix::Identity();
      scaling(i, i) = factor;
      covariance = scaling * covariance * scaling;
      mean(i) *= factor;
    };
    const bool is_off = step % 3 == 0;
    estimate.reset(i, 0.5 * i, is_off ? 0.0 : 2.0);
    scaled(0.0);
    mean(i) = 0.5 * i;
    covariance(i, i) = is_off ? 0.0 : 2.0;
    const int k = component(random);
    if (step % 5 == 0) estimate.add_noise(k, 0.3);
    if (step % 5 == 0) covariance(k, k) += 0.3;
    estimate.scale(i, 0.8);
    scaled(0.8);
    Vector h;
    for (int n = 0; n < kN; ++n) h(n) = normal(random);
    const double z = normal(random);
    const Vector gain = covariance * h / (h.dot(covariance * h) + 0.25);
    estimate.update(h, z - h.dot(estimate.mean()), 0.25, estimation::kNoGate);
    mean += gain * (z - h.dot(mean));
    covariance -= gain * (h.transpose() * covariance).eval();
    ASSERT_TRUE(estimate.is_sound());
    for (int c = 0; c < kN; ++c) {
      ASSERT_NEAR(estimate.mean(c), mean(c), 1e-11) << step;  // numbers near 1, rounding of a few hundred updates
      for (int r = 0; r < kN; ++r) ASSERT_NEAR(estimate.covariance(r, c), covariance(r, c), 1e-12) << step;
    }
  }
}

TEST(Estimate, IdleComponentsStayIdle) {
  estimation::Estimate<4> estimate;
  estimate.reset(0, 1.0, 4.0);
  estimate.reset(2, 3.0, 9.0);
  estimate.update({1.0, 1.0, 1.0, 1.0}, 2.0, 1.0, estimation::kNoGate);
  EXPECT_TRUE(estimate.is_inactive(1));
  EXPECT_TRUE(estimate.is_inactive(3));
  EXPECT_EQ(estimate.mean(1), 0.0);
  EXPECT_EQ(estimate.covariance(0, 1), 0.0);
  EXPECT_NE(estimate.covariance(0, 2), 0.0);
  estimate.reset(2, 0.0, 0.0);
  EXPECT_TRUE(estimate.is_inactive(2));
  EXPECT_EQ(estimate.covariance(0, 2), 0.0);
}

TEST(Estimate, TransformIsThePropagationOfTheWholeCovariance) {
  constexpr int kN = 5;
  constexpr int kM = 2;
  estimation::Estimate<kN> estimate;
  for (int i = 0; i < kN; ++i) estimate.reset(i, 1.0 + i, 1.0 + i);
  // Correlate everything with everything.
  estimate.update({1.0, -2.0, 0.5, 1.0, 3.0}, 0.7, 0.5, estimation::kNoGate);
  Eigen::Matrix<double, kN, kN> before;
  for (int i = 0; i < kN; ++i)
    for (int j = 0; j < kN; ++j) before(i, j) = estimate.covariance(i, j);

  const Eigen::Matrix<double, kM, kM> a{{1.0, 10.0}, {0.2, 0.9}};
  const Eigen::Matrix<double, kM, kM> q{{0.3, 0.1}, {0.1, 0.2}};
  estimate.transform_head<kM>({5.0, 6.0}, a, q);
  estimate.add_noise(4, 0.05);

  Eigen::Matrix<double, kN, kN> f = Eigen::Matrix<double, kN, kN>::Identity();
  f.topLeftCorner<kM, kM>() = a;
  Eigen::Matrix<double, kN, kN> expected = f * before * f.transpose();
  expected.topLeftCorner<kM, kM>() += q;
  expected(4, 4) += 0.05;
  for (int i = 0; i < kN; ++i)
    for (int j = 0; j < kN; ++j) EXPECT_NEAR(estimate.covariance(i, j), expected(i, j), 1e-12);
  EXPECT_EQ((estimate.head_covariance<kM>()),
            (Eigen::Matrix<double, kM, kM>{{estimate.covariance(0, 0), estimate.covariance(0, 1)},
                                           {estimate.covariance(1, 0), estimate.covariance(1, 1)}}));
  EXPECT_EQ(estimate.mean(0), 5.0);
  EXPECT_EQ(estimate.mean(1), 6.0);
}

TEST(Estimate, GateRefusesOutliersAndWhatIsNoNumber) {
  estimation::Estimate<2> estimate;
  estimate.reset(0, 0.0, 1.0);
  estimate.reset(1, 0.0, 1.0);
  const Eigen::Matrix<double, 2, 1> h(1.0, 0.0);
  for (const double residual : {10.0, double(NAN), double(INFINITY)}) {
    EXPECT_FALSE(estimate.update(h, residual, 1.0, 9.0).accepted) << residual;
    EXPECT_EQ(estimate.mean(0), 0.0);
    EXPECT_EQ(estimate.variance(0), 1.0);
  }
  EXPECT_FALSE(estimate.update(h, 1.0, NAN, 9.0).accepted);
  EXPECT_TRUE(estimate.update(h, 1.0, 1.0, 9.0).accepted);
  EXPECT_NEAR(estimate.mean(0), 0.5, 1e-15);
  EXPECT_TRUE(estimate.is_sound());
  estimate.shift(1, NAN);
  EXPECT_FALSE(estimate.is_sound());
}

TEST(Estimate, MillimetresBesideUnknownAmbiguities) {
  // The worst a phase filter asks of doubles: 50 m against 1 mm, a hundred times over. The covariance stays sound and
  // the difference of two ambiguities is known to what the phases say.
  estimation::Estimate<4> estimate;
  estimate.reset(0, 0.0, 1.0);     // position
  estimate.reset(1, 0.0, 2500.0);  // two ambiguities, m
  estimate.reset(2, 0.0, 2500.0);
  estimate.reset(3, 0.0, 1e6);  // clock
  for (int k = 0; k < 100; ++k) {
    estimate.update({0.6, 1.0, 0.0, 1.0}, 0.0, 1e-6, estimation::kNoGate);
    estimate.update({-0.8, 0.0, 1.0, 1.0}, 0.0, 1e-6, estimation::kNoGate);
    EXPECT_TRUE(estimate.is_sound());
    estimate.add_noise(3, 1e6);
  }
  const double difference = estimate.variance(1) + estimate.variance(2) - 2.0 * estimate.covariance(1, 2);
  // Single-difference of the two: known to 1.4 times the position (1.4 m) up to noise.
  EXPECT_NEAR(difference, 1.4 * 1.4 * estimate.variance(0), 1e-3);
}

TEST(Estimate, AsksNothingOfTheHeap) {
  static estimation::Estimate<80> estimate;
  const std::size_t before = test::allocation_count();
  for (int i = 0; i < 80; ++i) estimate.reset(i, 0.0, 1.0);
  estimation::Estimate<80>::Vector h = estimation::Estimate<80>::Vector::Ones();
  estimate.update(h, 1.0, 1.0, estimation::kNoGate);
  estimate.transform_head<12>(Eigen::Matrix<double, 12, 1>::Zero(), Eigen::Matrix<double, 12, 12>::Identity(),
                              Eigen::Matrix<double, 12, 12>::Identity());
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_TRUE(estimate.is_sound());
}

}  // namespace

namespace {

constexpr int kStates = 5;
constexpr int kMost = 6;
using SomeBatch = estimation::MeasurementBatch<kStates, kMost>;
using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// Correlated states, four rows of correlated noise of which the third is not in use.
class BatchCase : public testing::Test {
 protected:
  BatchCase() {
    Eigen::Matrix<double, kStates, kStates> root;
    for (int k = 0; k < root.size(); ++k) root(k) = normal();
    covariance = root * root.transpose();
    estimate.transform_head<kStates>(estimation::Estimate<kStates>::Vector::LinSpaced(1.0, 5.0),
                                     estimation::Estimate<kStates>::Matrix::Identity(), covariance);
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
  estimation::Estimate<kStates> estimate;
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
  ASSERT_TRUE(estimation::update(estimate, batch));
  for (int i = 0; i < kStates; ++i) {
    EXPECT_NEAR(estimate.mean(i), static_cast<double>(mean(i)), 1e-12);
    for (int j = 0; j < kStates; ++j) EXPECT_NEAR(estimate.covariance(i, j), static_cast<double>(rest(i, j)), 1e-12);
  }
  int r = 0;
  for (const int k : {0, 1, 3}) EXPECT_NEAR(batch.residual(k), static_cast<double>(postfit(r++)), 1e-12) << k;
  EXPECT_NEAR(batch.residual(2), unused, 1e-12);
}

TEST_F(BatchCase, NisAreThoseOfTheInverse) {
  estimation::predict_innovations(estimate, batch);
  const Wide s = h() * covariance.cast<long double>() * h().transpose() + of_used(batch.noise);
  const Wide expected = residual().transpose() * s.inverse() * residual();
  EXPECT_NEAR(estimation::joint_nis(batch), static_cast<double>(expected(0)), 1e-12 * static_cast<double>(expected(0)));
  const Eigen::Matrix2d pair = batch.innovation.topLeftCorner<2, 2>();
  const Eigen::Vector2d of_pair = batch.residual.head<2>();
  EXPECT_NEAR(estimation::group_nis(batch, 0, 2), of_pair.dot(pair.inverse() * of_pair), 1e-10);
  EXPECT_NEAR(estimation::group_nis(batch, 3, 1), batch.residual(3) * batch.residual(3) / batch.innovation(3, 3),
              1e-14);
}

TEST_F(BatchCase, ANoiseThatIsNoneChangesNothing) {
  batch.noise(1, 1) = -1.0;
  const auto mean = estimate.mean();
  EXPECT_FALSE(estimation::update(estimate, batch));
  EXPECT_EQ(estimate.mean(), mean);
  batch.noise(1, 1) = NAN;
  EXPECT_FALSE(estimation::update(estimate, batch));
  EXPECT_EQ(estimate.mean(), mean);
  batch.innovation(0, 0) = NAN;
  EXPECT_EQ(estimation::group_nis(batch, 0, 2), estimation::kNoGate);
  batch.innovation.setZero();
  EXPECT_EQ(estimation::joint_nis(batch), estimation::kNoGate);
}

/// A component of variance zero is not sampled, and the others as if it did not exist.
TEST(UnscentedTransform, InactiveComponentsAreNotSampled) {
  estimation::UnscentedTransform<3> transform;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) = 4.0;
  covariance(2, 2) = 9.0;
  covariance(0, 2) = covariance(2, 0) = 3.0;
  ASSERT_EQ(transform.start({1.0, 2.0, 3.0}, covariance), Status::kOk);
  std::array<Eigen::Matrix<double, 1, 1>, estimation::UnscentedTransform<3>::kPoints> values;
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

}  // namespace vbar::fsw::filter
