// Largest probability of collision of a drift, against the closed form of a spherical distribution and random samples.

#include "fsw/safety/drift_probability.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "fsw/safety/collision_probability.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::safety {
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
