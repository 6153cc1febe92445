#include "fsw/vision/stars/attitude_determination.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/star_sky.h"

namespace vbar::fsw::stars {
namespace {

constexpr double kArcsecond = 4.84813681109536e-6;

/// Directions in a field of the given radius, turned by noise.
std::vector<DirectionPair> draw_pairs(const Matrix3& R_camera_eci, std::size_t count, double radius, double sigma,
                                      sky::Random& random) {
  std::vector<DirectionPair> pairs;
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3 b =
        Vector3(radius * sky::uniform(random, -1, 1), radius * sky::uniform(random, -1, 1), 1.0).normalized();
    const Vector3 noise = sigma * Vector3(sky::normal(random), sky::normal(random), sky::normal(random));
    pairs.push_back({(b + noise - noise.dot(b) * b).normalized(), R_camera_eci.transpose() * b, sigma});
  }
  return pairs;
}

TEST(AttitudeDetermination, ReproducesAWorkedExample) {
  // Davenport's q-method in another implementation: three noisy directions of equal weight, q = [vector, scalar].
  const std::array<DirectionPair, 3> pairs{{
      {{0.7400259493081937, -0.5965574152158671, -0.3106136582661332}, Vector3::UnitX(), 1.0},
      {{0.5162448847918952, 0.8001430493813743, -0.3053888004706108}, Vector3::UnitY(), 1.0},
      {{0.9742300290453844, 0.15529628081582653, 0.16358152606881168}, Vector3::Ones().normalized(), 1.0},
  }};
  const auto found = determine_attitude(pairs);
  ASSERT_TRUE(found.ok());
  // A passive quaternion: the matrix is the transpose of the one that turns vectors.
  const Eigen::Quaterniond q(0.92736693, 0.100055995, -0.199951563, 0.299997911);
  EXPECT_LT((found.value().R_camera_eci - q.normalized().toRotationMatrix().transpose()).norm(), 1e-7);
  // The loss: sum of weights less the largest eigenvalue is half the sum of squared residuals.
  EXPECT_NEAR(found.value().chi_square / 3.0, 2.0 * (1.0 - 0.99999996946663), 1e-11);
  EXPECT_EQ(found.value().degrees_of_freedom, 3);
}

TEST(AttitudeDetermination, FindsExactAttitudesAnywhere) {
  sky::Random random(5);
  for (int k = 0; k < 1000; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    auto pairs = draw_pairs(truth, 2 + random() % 20, 0.1, 1e-5, random);
    for (DirectionPair& pair : pairs) pair.camera = truth * pair.eci;
    const auto found = determine_attitude(pairs);
    if (!found.ok()) continue;  // two directions by chance on one line
    // Rounding of 1e-16 over the squared width of the field, 1e-3 and less for pairs near each other.
    EXPECT_LT(sky::angle_between(found.value().R_camera_eci, truth), 1e-10);
  }
}

TEST(AttitudeDetermination, CovarianceIsThatOfTheErrors) {
  sky::Random random(6);
  const Matrix3 truth = sky::random_rotation(random);
  constexpr int kTrials = 4000;
  double squared = 0.0, chi_square = 0.0;
  for (int k = 0; k < kTrials; ++k) {
    const auto pairs = draw_pairs(truth, 12, 0.06, 3.45 * kArcsecond, random);
    const auto found = determine_attitude(pairs);
    ASSERT_TRUE(found.ok());
    const Matrix3 turn = found.value().R_camera_eci * truth.transpose();
    const Vector3 angle = 0.5 * Vector3(turn(1, 2) - turn(2, 1), turn(2, 0) - turn(0, 2), turn(0, 1) - turn(1, 0));
    squared += angle.dot(found.value().covariance_camera.inverse() * angle);
    chi_square += found.value().chi_square;
  }
  // Means of chi-square variables of 3 and 21 degrees of freedom, 4 sigma over the trials.
  EXPECT_NEAR(squared / kTrials, 3.0, 4.0 * std::sqrt(6.0 / kTrials));
  EXPECT_NEAR(chi_square / kTrials, 21.0, 4.0 * std::sqrt(42.0 / kTrials));
}

TEST(AttitudeDetermination, DropsTheWrongStarAndOnlyThat) {
  sky::Random random(7);
  int exact = 0;
  for (int k = 0; k < 500; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    auto pairs = draw_pairs(truth, 12, 0.06, 3.45 * kArcsecond, random);
    const int wrong = static_cast<int>(random() % 12);
    pairs[static_cast<std::size_t>(wrong)].camera =
        (pairs[static_cast<std::size_t>(wrong)].camera + Vector3(100 * kArcsecond, 0, 0)).normalized();
    std::array<int, 12> tags{};
    for (std::size_t t = 0; t < tags.size(); ++t) tags[t] = static_cast<int>(t);
    const auto found = determine_attitude_robustly(pairs, tags);
    ASSERT_TRUE(found.ok());
    if (found.value().kept == 11 && tags[11] == wrong) ++exact;
    // 29 sigma off: unmistakable, unless geometry hides it in roll.
    EXPECT_LT(sky::angle_between(found.value().estimate.R_camera_eci, truth), 200 * kArcsecond);
  }
  EXPECT_GE(exact, 495);  // the test itself refuses one set in 10,000
}

TEST(AttitudeDetermination, GivesUpWhereTooManyDisagree) {
  sky::Random random(8);
  auto pairs = draw_pairs(Matrix3::Identity(), 6, 0.06, 1 * kArcsecond, random);
  for (DirectionPair& pair : pairs) {
    pair.camera = (pair.camera + 1e-3 * Vector3(sky::normal(random), sky::normal(random), 0)).normalized();
  }
  std::array<int, 6> tags{};
  EXPECT_EQ(determine_attitude_robustly(pairs, tags).status(), Status::kDidNotConverge);
}

TEST(AttitudeDetermination, LimitOfResidualsIsExceededOnceInTenThousand) {
  // The tail of an odd number of degrees of freedom in closed form (Abramowitz and Stegun, 26.4.4).
  for (int degrees = 3; degrees < 400; degrees += 2) {
    const double x = chi_square_limit(degrees);
    double tail = std::erfc(std::sqrt(0.5 * x));
    double term = std::sqrt(2.0 / std::numbers::pi) * std::exp(-0.5 * x) * std::sqrt(x);
    for (int k = 1; k < degrees; k += 2) {
      tail += term;
      term *= x / (k + 2);
    }
    // The approximation's own error: it is a little generous for few directions.
    EXPECT_GT(tail, 0.6e-4) << degrees;
    EXPECT_LT(tail, 1.05e-4) << degrees;
  }
}

TEST(AttitudeDetermination, RefusesWhatGivesNoAttitude) {
  const DirectionPair x{Vector3::UnitX(), Vector3::UnitX(), 1.0};
  const DirectionPair z{Vector3::UnitZ(), Vector3::UnitZ(), 1.0};
  const auto status = [](std::array<DirectionPair, 2> pairs) { return determine_attitude(pairs).status(); };
  EXPECT_EQ(determine_attitude({}).status(), Status::kInvalidArgument);
  EXPECT_EQ(determine_attitude(std::array{x}).status(), Status::kInvalidArgument);
  EXPECT_EQ(status({x, x}), Status::kSingular);
  EXPECT_EQ(status({x, {z.camera, z.eci, 0.0}}), Status::kInvalidArgument);
  EXPECT_EQ(status({x, {z.camera, z.eci, -1.0}}), Status::kInvalidArgument);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status({x, {Vector3(kNan, 0, 0), z.eci, 1.0}}), Status::kNotFinite);
  EXPECT_EQ(status({x, {z.camera, z.eci, kNan}}), Status::kNotFinite);
  EXPECT_EQ(status({x, z}), Status::kOk);
}

}  // namespace
}  // namespace vbar::fsw::stars
