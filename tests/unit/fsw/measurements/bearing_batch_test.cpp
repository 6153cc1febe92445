#include "fsw/measurements/bearings/bearing_batch.h"

#include <memory>

#include <gtest/gtest.h>

#include "fsw/math/cholesky.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/vision/target_tracking/bearing.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::measurements {

namespace {

using namespace test;

constexpr double kSigma = 12.0 * kArcsec;
constexpr double kPeriod_s = 60.0;

/// Forty minutes of images 75 km behind, with a burn of the servicer in the middle if asked for.
struct Arc {
  explicit Arc(unsigned seed, double outlier_share = 0.0, bool burns = false, int images = 40) : noise(seed) {
    const Vector6 roe = roe_of_metres(-2000.0, -75000.0, 50.0, -100.0, 150.0, 20.0);
    prior_sigma << 30.0, 1000.0, 200.0, 200.0, 200.0, 200.0;
    orbit::CartesianState target = scene_target(scene_servicer(), roe);
    servicer = scene_servicer();
    GpsTime now = scene_start();
    for (int k = 0; k < images; ++k) {
      if (k > 0) {
        const filter::Propagation propagation(now, scene_earth(), scene_sun());
        servicer = propagation.coast(servicer, kPeriod_s);
        target = propagation.coast(target, kPeriod_s);
        now = now + nearest_duration(kPeriod_s);
      }
      Vector2 error = kSigma * noise.normal2();
      if (std::uniform_real_distribution<double>(0.0, 1.0)(strays) < outlier_share) error = 3e-3 * noise.normal2();
      batch->add(bearing_of(now, servicer, target, kSigma, error));
      if (burns && k == images / 2) {
        const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * Vector3(0.0, -0.34, -0.35);
        servicer.velocity_eci += dv_eci;
        batch->add_burn(now, dv_eci);
      }
    }
    true_roe =
        orbit::roe_from_qns(orbit::qns_from_cartesian(servicer).value(), orbit::qns_from_cartesian(target).value());
    prior_covariance = (prior_sigma / kA).cwiseAbs2().asDiagonal();
    prior_roe = true_roe + (prior_sigma / kA).cwiseProduct(noise.normal6());
  }

  Result<BatchSolution> solve(const BearingBatchSettings& settings = {}) {
    return batch->solve(servicer, prior_roe, prior_covariance, scene_earth(), scene_sun(), settings);
  }

  /// Six on average if the covariance is right.
  double nees(const BatchSolution& solution) const {
    const Vector6 error = solution.roe - true_roe;
    const Matrix6 covariance = solution.covariance.topLeftCorner<6, 6>();
    return error.dot(math::Cholesky6(covariance).solve(error));
  }

  Noise noise;
  std::mt19937 strays{7};
  std::unique_ptr<BearingBatch> batch = std::make_unique<BearingBatch>();
  orbit::CartesianState servicer;
  Vector6 prior_sigma, prior_roe, true_roe;
  Matrix6 prior_covariance;
};

// 99.9 % of chi-square: 60 degrees of freedom between 30 and 103, 12 between 2.2 and 32.9.
constexpr int kArcs = vbar::test::kAddressSanitizer ? 2 : 10;
constexpr double kMinNees = (vbar::test::kAddressSanitizer ? 2.2 : 30.0) / kArcs;
constexpr double kMaxNees = (vbar::test::kAddressSanitizer ? 32.9 : 103.0) / kArcs;

TEST(BearingBatch, IsAsGoodAsItSaysAndBetterThanWhatWasKnown) {
  double nees = 0.0;
  for (unsigned seed = 1; seed <= kArcs; ++seed) {
    Arc arc(seed);
    const auto solution = arc.solve();
    ASSERT_TRUE(solution.ok()) << static_cast<int>(solution.status());
    nees += arc.nees(solution.value()) / kArcs;
    EXPECT_NEAR(solution.value().chi_square, 1.0, 0.5);  // of 80 numbers: 3 sigma
    // 12 arcsec at 75 km are 4.4 m, half an orbit of them pins the out-of-plane motion to a few.
    EXPECT_LT(kA * std::sqrt(solution.value().covariance(4, 4)), 20.0);
    EXPECT_LT(solution.value().covariance(1, 1), arc.prior_covariance(1, 1));
  }
  EXPECT_GT(nees, kMinNees);
  EXPECT_LT(nees, kMaxNees);
}

TEST(BearingBatch, KnowsItsBurns) {
  double nees = 0.0;
  for (unsigned seed = 1; seed <= kArcs; ++seed) {
    Arc arc(seed, 0.0, true);
    const auto solution = arc.solve();
    ASSERT_TRUE(solution.ok());
    nees += arc.nees(solution.value()) / kArcs;
  }
  EXPECT_GT(nees, kMinNees);
  EXPECT_LT(nees, kMaxNees);
}

TEST(BearingBatch, BearsWithStrayBearings) {
  double nees = 0.0;
  for (unsigned seed = 1; seed <= kArcs; ++seed) {
    Arc arc(seed, 0.1);
    const auto solution = arc.solve();
    ASSERT_TRUE(solution.ok()) << static_cast<int>(solution.status());
    EXPECT_LT(solution.value().used, 40);
    nees += arc.nees(solution.value()) / kArcs;
  }
  // Four strays of ten arc minutes pull as three sigma each: half as much again may be lost.
  EXPECT_LT(nees, 1.5 * kMaxNees);
}

TEST(BearingBatch, RefusesWhatIsNoOrbit) {
  Arc garbage(1, 1.0);
  EXPECT_FALSE(garbage.solve().ok());
  Arc few(1, 0.0, false, 9);
  EXPECT_EQ(few.solve().status(), Status::kNotReady);
  Arc singular(1);
  singular.prior_covariance.setZero();
  EXPECT_EQ(singular.solve().status(), Status::kSingular);
  Arc not_finite(1);
  not_finite.prior_roe(2) = NAN;
  EXPECT_FALSE(not_finite.solve().ok());
}

TEST(BearingBatch, KeepsTheYoungerHalfWhenItIsFull) {
  Arc arc(1, 0.0, false, static_cast<int>(BearingBatch::kCapacity) + 1);
  EXPECT_EQ(arc.batch->size(), BearingBatch::kCapacity / 2 + 1);
  EXPECT_EQ(arc.batch->first_time(), scene_start() + nearest_duration(60 * kPeriod_s));
  EXPECT_TRUE(arc.solve().ok());
}

}  // namespace

namespace {

TEST(BearingAxes, AreThoseOfTheOrbitForATargetBehind) {
  const orbit::CartesianState servicer = scene_servicer();
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const Matrix3 axes = target_tracking::bearing_axes(-R_rtn_eci.row(1).transpose(), servicer);
  EXPECT_LT((axes.row(0) - R_rtn_eci.row(0)).norm(), 1e-12);  // up
  EXPECT_LT((axes.row(1) - R_rtn_eci.row(2)).norm(), 1e-12);  // orbit normal
  // Straight along the normal there is no vertical, but there are axes.
  const Matrix3 above = target_tracking::bearing_axes(R_rtn_eci.row(2).transpose(), servicer);
  EXPECT_LT((above * above.transpose() - Matrix3::Identity()).norm(), 1e-12);
}

// Tango by Monte Carlo with the renderer (bearing.h), over the value at 90 deg, known to a sixth.
TEST(CentroidScatter, GrowsWithThePhaseAngle) {
  constexpr double kDegree = M_PI / 180.0;
  EXPECT_NEAR(target_tracking::centroid_scatter_growth(std::cos(45.0 * kDegree)), 5.7 / 9.7, 0.1);
  EXPECT_NEAR(target_tracking::centroid_scatter_growth(std::cos(90.0 * kDegree)), 1.0, 1e-9);
  EXPECT_NEAR(target_tracking::centroid_scatter_growth(std::cos(140.0 * kDegree)), 20.0 / 9.7, 0.35);
}

/// Against a Lambert sphere (Lindegren 1977), whose offset at a phase angle a is its radius times
/// (3 pi/16) (1 + cos a) sin a / (sin a + (pi - a) cos a).
TEST(CentreOfBrightness, LiesAcrossTheLineOfSightOnTheLitSideAsThatOfASphere) {
  const Vector3 target(7e6, 0.0, 0.0), camera(7e6, 1000.0, 0.0);
  for (const double phase : {0.3, 0.8, M_PI / 2.0, 1.7}) {
    // From the target the camera is in the direction +y.
    const Vector3 sun(std::sin(phase), std::cos(phase), 0.0);
    const double offset = 0.2;
    const Vector3 centre = target_tracking::centre_of_brightness(target, camera, sun, {.to_sun_m = offset});
    const double lune = std::sin(phase) + (M_PI - phase) * std::cos(phase);
    const double sphere = offset * (1.0 + std::cos(phase)) * std::sin(phase) / lune;
    EXPECT_NEAR((centre - target).x(), sphere, 0.13 * sphere) << phase;
    EXPECT_NEAR((centre - target).y(), 0.0, 1e-9);
    EXPECT_NEAR((centre - target).z(), 0.0, 1e-9);
  }
  // A body of flat faces has no more at larger angles: Tango by Monte Carlo (bearing.h).
  const double angle = 140.0 * M_PI / 180.0;
  const Vector3 sun(std::sin(angle), std::cos(angle), 0.0);
  EXPECT_NEAR(target_tracking::centre_of_brightness(target, camera, sun, {.to_sun_m = 0.163}).x() - target.x(), 0.164,
              0.03);
  // Full target: none.
  EXPECT_LT((target_tracking::centre_of_brightness(target, camera, Vector3(0.0, 1.0, 0.0), {.to_sun_m = 0.2}) - target)
                .norm(),
            1e-9);
}

/// The part of the vector towards the Earth across the line of sight: all of it for a target ahead, none for one below.
TEST(CentreOfBrightness, LiesTowardsTheEarthByItsLight) {
  const Vector3 camera(7e6, 0.0, 0.0), sun = Vector3::UnitZ();
  const auto moved = [&](const Vector3& target) -> Vector3 {
    return target_tracking::centre_of_brightness(target, camera, sun, {.to_earth_m = 0.03}) - target;
  };
  // A kilometre ahead the directions to the Earth differ by 1.4e-4 rad.
  EXPECT_LT((moved({7e6, 1000.0, 0.0}) - Vector3(-0.03, 0.0, 0.0)).norm(), 1e-5);
  EXPECT_LT(moved({6.999e6, 0.0, 0.0}).norm(), 1e-9);
  // 45 deg below: sin 45 deg of it, at 45 deg to both.
  EXPECT_LT((moved({6.999e6, 1000.0, 0.0}) - Vector3(-0.015, -0.015, 0.0)).norm(), 1e-5);
}

}  // namespace

}  // namespace vbar::fsw::measurements
