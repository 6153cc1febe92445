// Probability of collision against NASA CARA's test cases, closed forms, brute force and Monte Carlo.

#include "fsw/safety/collision_probability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::safety {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Matrix3 rotated(const Vector3& sigmas, const Vector3& axis, double angle) {
  const Matrix3 R = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return R * sigmas.cwiseAbs2().asDiagonal() * R.transpose();
}

/// Integral of the density over the ball by the midpoint rule in spherical coordinates: slow, simple, independent.
double brute_force(const Vector3& mean, const Matrix3& covariance, double radius, int n) {
  const Matrix3 R = covariance.inverse();
  const double norm = 1.0 / std::sqrt(std::pow(2.0 * kPi, 3) * covariance.determinant());
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double r = (i + 0.5) * radius / n;
    for (int j = 0; j < n; ++j) {
      const double z = -1.0 + (j + 0.5) * 2.0 / n;
      const double rho = std::sqrt(1.0 - z * z);
      for (int k = 0; k < n; ++k) {
        const double longitude = (k + 0.5) * 2.0 * kPi / n;
        const Vector3 x = r * Vector3(rho * std::cos(longitude), rho * std::sin(longitude), z) - mean;
        sum += r * r * std::exp(-0.5 * x.dot(R * x));
      }
    }
  }
  return sum * norm * (radius / n) * (2.0 / n) * (2.0 * kPi / n);
}

TEST(IsotropicProbability, MatchesMonteCarlo) {
  // Monte Carlo over 4e6 samples gave 0.06186; the closed form evaluated elsewhere 0.061888825, and 0.198748 at the
  // centre.
  EXPECT_NEAR(collision_probability_isotropic(5.0, 2.0, 3.0).value(), 0.061888825, 5e-10);
  EXPECT_NEAR(collision_probability_isotropic(0.0, 1.0, 1.0).value(), 0.198748, 5e-7);
}

TEST(IsotropicProbability, HasItsLimits) {
  EXPECT_NEAR(collision_probability_isotropic(1.0, 1e-3, 2.0).value(), 1.0, 1e-15);  // 1000 sigma inside
  EXPECT_EQ(collision_probability_isotropic(100.0, 1.0, 2.0).value(), 0.0);          // underflows
  EXPECT_EQ(collision_probability_isotropic(1.0, 1.0, 0.0).value(), 0.0);
  // A small ball holds its volume times the density.
  const double r = 1e-3;
  const double density = std::exp(-0.5 * 4.0) / std::pow(2.0 * kPi, 1.5);
  // relative r^2 from the curvature of the density, and rounding of 0.05 over 2e-10
  EXPECT_NEAR(collision_probability_isotropic(2.0, 1.0, r).value() / (4.0 / 3.0 * kPi * r * r * r * density), 1.0,
              2e-6);
  // Through the change of formula near the centre: continuous to what either neglects or rounds.
  EXPECT_NEAR(collision_probability_isotropic(0.99e-5, 1.0, 1.0).value(),
              collision_probability_isotropic(1.01e-5, 1.0, 1.0).value(), 1e-10);
}

TEST(IsotropicProbability, IsNonCentralMaxwell) {
  // P' = sqrt(2/pi) r/(d s) sinh(r d/s^2) exp(-(r^2+d^2)/(2 s^2)), integrated by the midpoint rule (error 1e-9).
  const double d = 3.0;
  const double s = 1.7;
  const double radius = 4.0;
  double sum = 0.0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double r = (k + 0.5) * radius / n;
    sum += std::sqrt(2.0 / kPi) * r / (d * s) * std::sinh(r * d / (s * s)) * std::exp(-(r * r + d * d) / (2.0 * s * s));
  }
  EXPECT_NEAR(collision_probability_isotropic(d, s, radius).value(), sum * radius / n, 1e-8);
}

TEST(Probability, OfASphericalDistributionIsTheClosedForm) {
  for (double distance : {0.0, 0.5, 2.0, 5.0, 9.0}) {
    for (double sigma : {0.5, 1.0, 2.0, 10.0}) {
      const double expected = collision_probability_isotropic(distance, sigma, 1.0).value();
      const Vector3 mean = distance * Vector3(1.0, -2.0, 0.5).normalized();
      const double p = collision_probability(mean, sigma * sigma * Matrix3::Identity(), 1.0).value();
      // The header's 1e-6 for sigmas from half the radius; below 1e-16 tails of 8.5 sigma are left out.
      EXPECT_NEAR(p, expected, 1e-6 * expected + 1e-16) << "d = " << distance << ", s = " << sigma;
    }
  }
}

TEST(Probability, OfAnyDistributionMatchesBruteForce) {
  struct Case {
    Vector3 mean, sigmas;
    double radius;
  };
  const Vector3 axis(1.0, 2.0, -0.5);
  for (const Case& c : {Case{{3.0, 1.0, -2.0}, {1.0, 4.0, 2.0}, 2.0}, Case{{0.3, 0.1, 0.0}, {0.5, 8.0, 1.0}, 1.0},
                        Case{{0.0, 6.0, 1.0}, {0.6, 3.0, 0.7}, 1.2}}) {
    const Matrix3 covariance = rotated(c.sigmas, axis, 0.8);
    const double p = collision_probability(c.mean, covariance, c.radius).value();
    // Midpoint rule with 120 points an axis: 2e-4 relative for features of half the radius.
    EXPECT_NEAR(p / brute_force(c.mean, covariance, c.radius, 120), 1.0, 2e-4);
  }
}

TEST(Probability, OfAFlatDistributionMatchesMonteCarlo) {
  // A thirtieth of the radius thin, as a well-observed axis is: the header promises 1e-3.
  std::mt19937_64 generator(8);
  std::normal_distribution<double> normal;
  const Vector3 sigmas(0.05, 1.0, 4.0);
  for (const Vector3& mean : {Vector3(0.5, 0.5, 1.0), Vector3(1.45, 0.2, 0.0)}) {
    const double radius = 1.5;
    int hits = 0;
    constexpr int kSamples = 1000000;
    for (int k = 0; k < kSamples; ++k) {
      const Vector3 x = mean + sigmas.cwiseProduct(Vector3(normal(generator), normal(generator), normal(generator)));
      if (x.squaredNorm() < radius * radius) ++hits;
    }
    const double monte_carlo = static_cast<double>(hits) / kSamples;
    const double p = collision_probability(mean, sigmas.cwiseAbs2().asDiagonal(), radius).value();
    EXPECT_NEAR(p, monte_carlo, 4.0 * std::sqrt(p / kSamples) + 1e-3 * p);  // four sigma of the count
  }
}

TEST(Probability, InThePlaneIsAnUpperBoundInSpace) {
  // Taking one axis as unknown cannot lower the probability: the disk's cylinder contains the ball.
  const Vector3 mean(0.5, 12.0, 1.5);
  const Matrix3 covariance = Vector3(0.4, 6.0, 0.3).cwiseAbs2().asDiagonal();
  const double in_space = collision_probability(mean, covariance, 1.0).value();
  const Vector2 rn(mean.x(), mean.z());
  Matrix2 rn_covariance = Matrix2::Zero();
  rn_covariance(0, 0) = covariance(0, 0);
  rn_covariance(1, 1) = covariance(2, 2);
  EXPECT_GT(collision_probability_in_plane(rn, rn_covariance, 1.0).value(), in_space);
}

TEST(ProbabilityInPlane, OfACentredCircularDistributionIsRayleighs) {
  for (double ratio : {0.1, 1.0, 3.0, 9.0}) {
    const double p = collision_probability_in_plane(Vector2::Zero(), Matrix2::Identity(), ratio).value();
    EXPECT_NEAR(p, -std::expm1(-0.5 * ratio * ratio), 1e-6 * p);  // the header's accuracy
  }
}

/// NASA CARA Analysis Tools, PcElrod and Pc2D_Foster unit tests ("Omitron" cases). km, km/s, km^2.
struct CaraCase {
  Vector3 r1, v1, r2, v2;
  Matrix3 c1, c2;
  double radius;
  double expected;
};

std::array<CaraCase, 2> cara_cases() {
  std::array<CaraCase, 2> cases;
  cases[0] = {.r1 = {378.39559, 4305.721887, 5752.767554},
              .v1 = {2.360800244, 5.580331936, -4.322349039},
              .r2 = {374.5180598, 4307.560983, 5751.130418},
              .v2 = {-5.388125081, -3.946827739, 3.322820358},
              .c1 = Matrix3::Zero(),
              .c2 = Matrix3::Zero(),
              .radius = 0.020,
              .expected = 2.70601573490125e-5};
  cases[0].c1 << 44.5757544811362, 81.6751751052616, -67.8687662707124,  //
      81.6751751052616, 158.453402956163, -128.616921644857,             //
      -67.8687662707124, -128.616921644858, 105.490542562701;
  cases[0].c2 << 2.31067077720423, 1.69905293875632, -1.4170164577661,  //
      1.69905293875632, 1.24957388457206, -1.04174164279599,            //
      -1.4170164577661, -1.04174164279599, 0.869260558223714;
  cases[1] = {.r1 = {-3239.128337196251, 2404.575152356222, 5703.228541709001},
              .v1 = {-3.745768373154199, 5.012339015927846, -4.231864565717194},
              .r2 = {-3239.138264917246, 2404.568320465936, 5703.235605231182},
              .v2 = {6.110192790100711, -1.767321407894830, 4.140369261741708},
              .c1 = Matrix3::Zero(),
              .c2 = Matrix3::Zero(),
              .radius = 0.020,
              .expected = 0.180736305849476};
  cases[1].c1 << 0.342072996423899e-3, -0.412677096778269e-3, 0.371500417511149e-3,  //
      -0.412677096778269e-3, 0.609905946319294e-3, -0.540401385544286e-3,            //
      0.371500417511149e-3, -0.540401385544286e-3, 0.521238634755377e-3;
  cases[1].c2 << 0.028351300975134, -0.008204103437377, 0.019253747960155,  //
      -0.008204103437377, 0.002404377774847, -0.005586512197914,            //
      0.019253747960155, -0.005586512197914, 0.013289250260317;
  return cases;
}

TEST(ShortEncounter, MatchesNasaCara) {
  for (const CaraCase& c : cara_cases()) {
    const double p = collision_probability_short_encounter(1e3 * (c.r2 - c.r1), 1e3 * (c.v2 - c.v1),
                                                           1e6 * (c.c1 + c.c2), 1e3 * c.radius)
                         .value();
    EXPECT_NEAR(p / c.expected, 1.0, 1e-3);  // CARA's own tolerance
  }
}

TEST(ShortEncounter, DoesNotSeeAlongTheRelativeVelocity) {
  const Vector3 velocity(0.0, 7000.0, 0.0);
  const Matrix3 covariance = Vector3(100.0, 1e4, 50.0).cwiseAbs2().asDiagonal();
  const double p = collision_probability_short_encounter({30.0, 0.0, 40.0}, velocity, covariance, 10.0).value();
  const double shifted = collision_probability_short_encounter({30.0, 500.0, 40.0}, velocity, covariance, 10.0).value();
  EXPECT_NEAR(shifted / p, 1.0, 1e-12);
  Matrix2 plane = Matrix2::Zero();
  plane(0, 0) = 1e4;
  plane(1, 1) = 2500.0;
  EXPECT_NEAR(collision_probability_in_plane({30.0, 40.0}, plane, 10.0).value() / p, 1.0, 1e-12);
  EXPECT_TRUE(collision_probability_short_encounter(Vector3::Zero(), velocity, covariance, 10.0).ok());  // head on
}

TEST(ShortEncounter, MaximumOverCovarianceScales) {
  // Isotropic: R^2/(e d^2) = 3.679e-3 for R/d = 0.1.
  const Vector3 velocity(1.0, 0.0, 0.0);
  EXPECT_NEAR(
      maximum_probability_short_encounter({0.0, 100.0, 0.0}, velocity, 25.0 * Matrix3::Identity(), 10.0).value(),
      3.679e-3, 5e-7);
  // Scanning the scale of a general covariance finds the same maximum; the closed form neglects (R/d)^2 = 1e-4.
  const Vector3 miss(0.0, 80.0, 60.0);
  const Matrix3 shape = rotated({10.0, 30.0, 12.0}, {1.0, 0.0, 0.0}, 0.5);
  accuracy::Largest largest;
  for (double k = 0.5; k < 10.0; k *= 1.01) {
    const double p = collision_probability_short_encounter(miss, velocity, k * k * shape, 1.0).value();
    largest.add(p);
  }
  EXPECT_NEAR(maximum_probability_short_encounter(miss, velocity, shape, 1.0).value() / largest, 1.0, 1e-3);
  EXPECT_EQ(maximum_probability_short_encounter({0.0, 0.5, 0.0}, velocity, shape, 1.0).value(), 1.0);
}

TEST(Probability, RefusesWhatIsNoDistribution) {
  const Matrix3 unit = Matrix3::Identity();
  EXPECT_EQ(collision_probability_isotropic(1.0, 0.0, 1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(collision_probability_isotropic(-1.0, 1.0, 1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(collision_probability_isotropic(1.0, kNan, 1.0).status(), Status::kNotFinite);
  EXPECT_EQ(collision_probability(Vector3::Zero(), unit, -1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(collision_probability(Vector3::Zero(), unit, kNan).status(), Status::kNotFinite);
  EXPECT_EQ(collision_probability(Vector3(kNan, 0.0, 0.0), unit, 1.0).status(), Status::kNotFinite);
  EXPECT_EQ(collision_probability(Vector3::Zero(), kNan * unit, 1.0).status(), Status::kNotFinite);
  EXPECT_EQ(collision_probability(Vector3::Zero(), -unit, 1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(collision_probability_in_plane(Vector2::Zero(), Matrix2::Zero(), 1.0).status(), Status::kOutOfRange);
  EXPECT_EQ(collision_probability_short_encounter(Vector3::Ones(), Vector3::Zero(), unit, 1.0).status(),
            Status::kOutOfRange);
  EXPECT_EQ(maximum_probability_short_encounter(Vector3::Ones(), Vector3::Ones(), -unit, 0.1).status(),
            Status::kOutOfRange);
  EXPECT_EQ(collision_probability(Vector3::Zero(), unit, 0.0).value(), 0.0);
}

}  // namespace

// Largest probability of collision of a drift, against the closed form of a spherical distribution and random samples.

namespace {

const orbit::QnsElements& servicer() {
  return orbit::mission::kServicerMean;
}

// A target at rest along track (J2 leaves it) with an uncertainty along track only: a line through a sphere.
TEST(DriftProbability, OfOneUncertainCoordinateIsThatOfALine) {
  const LinearDrift drift = LinearDrift::make(servicer(), 600.0).value();
  Vector6 a_roe = Vector6::Zero();
  a_roe(1) = 10.0;
  Matrix6 covariance = Matrix6::Zero();
  covariance(1, 1) = 9.0;
  // The other axes have to have a width for the integral; so small that it does not matter.
  covariance(2, 2) = covariance(3, 3) = covariance(4, 4) = covariance(5, 5) = 1e-6;
  const auto p = drift_probability(drift, a_roe, covariance, 2.0);
  ASSERT_TRUE(p.ok());
  const auto below = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  EXPECT_NEAR(p.value().spatial, below((-10.0 + 2.0) / 3.0) - below((-10.0 - 2.0) / 3.0), 2e-5);
  EXPECT_NEAR(p.value().radial_normal, 1.0, 1e-6) << "nothing separates them across the flight direction";
}

// The probability at each of many samples, by counting: the largest must be that found by the three nearest.
TEST(DriftProbability, IsTheLargestOfTheDrift) {
  const LinearDrift drift = LinearDrift::make(servicer(), 12000.0).value();
  Vector6 a_roe;
  a_roe << 0.3, -4.0, 1.0, 0.5, 0.6, 1.4;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << 0.01, 0.25, 0.04, 0.04, 0.04, 0.04;
  const auto found = drift_probability(drift, a_roe, covariance, 2.0);
  ASSERT_TRUE(found.ok());
  accuracy::Largest largest;
  for (int sample = 0; sample < drift.samples(); ++sample) {
    const PositionMap map = drift.map_at(sample);
    const auto p = collision_probability(map * a_roe, map * covariance * map.transpose(), 2.0);
    ASSERT_TRUE(p.ok());
    largest.add(p.value());
  }
  EXPECT_NEAR(found.value().spatial, largest, 1e-9);
  EXPECT_GE(found.value().radial_normal, found.value().spatial);

  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  accuracy::Largest most;
  for (int sample = 0; sample < drift.samples(); sample += 2) {
    int hits = 0;
    constexpr int kDraws = 4000;
    for (int k = 0; k < kDraws; ++k) {
      Vector6 x = a_roe;
      for (int i = 0; i < 6; ++i) x(i) += std::sqrt(covariance(i, i)) * normal(random);
      if ((drift.map_at(sample) * x).norm() < 2.0) ++hits;
    }
    most.add(static_cast<double>(hits) / kDraws);
  }
  EXPECT_NEAR(found.value().spatial, most, 0.03);
}

TEST(DriftProbability, FarAwayItIsZero) {
  const LinearDrift drift = LinearDrift::make(servicer(), 86400.0).value();
  Vector6 a_roe;
  a_roe << 0.0, -1000.0, 0.0, 30.0, 0.0, 30.0;
  const auto p = drift_probability(drift, a_roe, 1e-4 * Matrix6::Identity(), 2.0);
  ASSERT_TRUE(p.ok());
  EXPECT_EQ(p.value().spatial, 0.0);
  EXPECT_EQ(p.value().radial_normal, 0.0);
}

TEST(DriftProbability, RefusesWhatIsNotFinite) {
  const LinearDrift drift = LinearDrift::make(servicer(), 600.0).value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(drift_probability(drift, Vector6::Constant(nan), Matrix6::Identity(), 2.0).status(), Status::kNotFinite);
  EXPECT_EQ(drift_probability(drift, Vector6::Zero(), nan * Matrix6::Identity(), 2.0).status(), Status::kNotFinite);
}

}  // namespace

}  // namespace vbar::fsw::safety
