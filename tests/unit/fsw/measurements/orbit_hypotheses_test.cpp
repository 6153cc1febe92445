#include "fsw/measurements/bearings/orbit_hypotheses.h"

#include <memory>

#include <gtest/gtest.h>

#include "fsw/math/cholesky.h"
#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::measurements {
namespace {

using namespace test;

constexpr double kSigma = 5.0 * kArcsec;
constexpr double kSlow = 2.0 * kArcsec;

/// A window of bearings, one a minute, to a target 3.7 km behind, whose orbit was estimated to 0.6 m before.
struct Window {
  /// `burn_rtn`: of the servicer, unknown, a minute before the first bearing; `scatter`: factor of the noise.
  Window(unsigned seed, int images, const Vector3& burn_rtn, double scatter) {
    Noise noise(seed);
    const Vector6 estimated_roe = roe_of_metres(-5.0, -3700.0, 0.0, 300.0, 0.0, 300.0);
    Vector6 sigma;
    sigma << 0.02, 0.6, 0.05, 0.05, 0.05, 0.05;
    sigma /= kA;
    orbit::CartesianState servicer = scene_servicer();
    orbit::CartesianState target = scene_target(servicer, estimated_roe + sigma.cwiseProduct(noise.normal6()));
    orbit::CartesianState without_burn = servicer, without_target = scene_target(servicer, estimated_roe);
    servicer = orbit::apply_impulse_rtn(servicer, burn_rtn);
    GpsTime now = scene_start();
    for (int k = 0; k < images; ++k) {
      const filter::Propagation propagation(now, scene_earth(), scene_sun());
      for (orbit::CartesianState* state : {&servicer, &target, &without_burn, &without_target})
        *state = propagation.coast(*state, 60.0);
      now = now + duration_of_seconds(60);
      bearings->add(bearing_of(now, servicer, target, kSigma, scatter * kSigma * noise.normal2()));
    }
    // The receiver follows the burn, so the filter knows the servicer and takes the target from the ROE it had.
    estimated.servicer = servicer;
    estimated.roe = orbit::roe_from_qns(orbit::qns_from_cartesian(without_burn).value(),
                                        orbit::qns_from_cartesian(without_target).value());
    estimated.covariance = sigma.cwiseAbs2().asDiagonal();
    estimated.common_sigma = kSlow;
    estimated.distance_m = 3700.0;
    estimated.unseen_s = 60.0 * images;
    estimated.earth = scene_earth();
    estimated.sun_eci = scene_sun();
    true_roe =
        orbit::roe_from_qns(orbit::qns_from_cartesian(servicer).value(), orbit::qns_from_cartesian(target).value());
  }

  std::unique_ptr<BearingBatch> bearings = std::make_unique<BearingBatch>();
  EstimatedOrbit estimated;
  Vector6 true_roe;
};

// A threshold of ln(1000) is crossed by fewer than one in a thousand windows of a right hypothesis (Kass, Raftery
// 1995): by two of 60 windows with a probability of 0.2 %.
TEST(OrbitHypotheses, ScatterOfWhateverSizeIsNotAChangeOfTheOrbit) {
  int changes = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const double scatter = seed % 3 == 0 ? 1.0 : seed % 3 == 1 ? 4.0 : 8.0;
    Window window(seed, 5 + static_cast<int>(seed % 10), Vector3::Zero(), scatter);
    const auto verdict = weigh_orbits(*window.bearings, window.estimated);
    ASSERT_TRUE(verdict.ok());
    changes += verdict.value().log_odds > std::log(1000.0) ? 1 : 0;
    // The variance of ten numbers is known to a factor of two or three.
    EXPECT_GT(verdict.value().scatter, 0.2 * scatter * scatter) << seed;
    EXPECT_LT(verdict.value().scatter, 4.0 * scatter * scatter) << seed;
  }
  EXPECT_LE(changes, 1);
}

TEST(OrbitHypotheses, AnUnknownBurnIsFoundAndTheOrbitRevised) {
  for (const double dv : {3e-3, 2e-2, 0.1}) {
    double nees = 0.0;
    constexpr int kSeeds = 6;
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      Window window(seed, 12, dv * Vector3(0.4, -0.6, 0.7), 1.0);
      const auto verdict = weigh_orbits(*window.bearings, window.estimated);
      ASSERT_TRUE(verdict.ok());
      EXPECT_GT(verdict.value().log_odds, std::log(1000.0)) << dv << " " << seed;
      const auto revised = revised_orbit(*window.bearings, window.estimated, verdict.value());
      ASSERT_TRUE(revised.ok()) << dv << " " << seed;
      const Vector6 error = revised.value().roe - window.true_roe;
      nees += error.dot(math::Cholesky6(revised.value().covariance).solve(error)) / kSeeds;
    }
    // Chi-square of 36 degrees of freedom: 99.9 % below 67.
    EXPECT_LT(nees, 67.0 / kSeeds) << dv;
  }
}

// In eleven minutes 0.05 mm/s move the target by three centimetres: within its uncertainty.
TEST(OrbitHypotheses, ABurnWithinTheUncertaintyOfTheOrbitIsNone) {
  Window window(1, 12, 5e-5 * Vector3(0.4, -0.6, 0.7), 1.0);
  const auto verdict = weigh_orbits(*window.bearings, window.estimated);
  ASSERT_TRUE(verdict.ok());
  EXPECT_LT(verdict.value().log_odds, 0.0);
}

TEST(OrbitHypotheses, RefusesAnEmptyWindowAndAnOrbitThatIsNone) {
  Window window(1, 0, Vector3::Zero(), 1.0);
  EXPECT_EQ(weigh_orbits(*window.bearings, window.estimated).status(), Status::kNotReady);
  Window singular(1, 8, Vector3::Zero(), 1.0);
  singular.estimated.covariance.setZero();
  EXPECT_EQ(weigh_orbits(*singular.bearings, singular.estimated).status(), Status::kSingular);
}

}  // namespace
}  // namespace vbar::fsw::measurements
