#include "fsw/navigation/roe_filter.h"

#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/math/cholesky6.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::navigation {
namespace {

using namespace test;

const Vector6 kRoe = roe_of_metres(-87.0, -50000.0, 30.0, 1000.0, -20.0, 1000.0);

Matrix6 diagonal_covariance(double da, double dl, double rest) {
  Vector6 sigma;
  sigma << da, dl, rest, rest, rest, rest;
  return (sigma / kA).cwiseAbs2().asDiagonal();
}

RoeFilterSettings without_pushes() {
  RoeFilterSettings settings;
  settings.acceleration = {.psd = 1e-30, .psd_min = 1e-30, .psd_max = 1e-30};
  settings.along_track_sigma = 1e-15;
  settings.from_sun_sigma = 1e-15;
  return settings;
}

TEST(BearingAxes, AreThoseOfTheOrbitForATargetBehind) {
  const orbit::CartesianState servicer = scene_servicer();
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const Matrix3 axes = bearing_axes(-R_rtn_eci.row(1).transpose(), servicer);
  EXPECT_LT((axes.row(0) - R_rtn_eci.row(0)).norm(), 1e-12);  // up
  EXPECT_LT((axes.row(1) - R_rtn_eci.row(2)).norm(), 1e-12);  // orbit normal
  // Straight along the normal there is no vertical, but there are axes.
  const Matrix3 above = bearing_axes(R_rtn_eci.row(2).transpose(), servicer);
  EXPECT_LT((above * above.transpose() - Matrix3::Identity()).norm(), 1e-12);
}

TEST(CentreOfBrightness, LiesAcrossTheLineOfSightOnTheLitSide) {
  const Vector3 target(7e6, 0.0, 0.0), camera(7e6, 1000.0, 0.0);
  const Vector3 sun = Vector3(1.0, 1.0, 0.0).normalized();
  // The sun's direction across the sight (-y) is +x, of length cos 45 deg.
  EXPECT_LT((centre_of_brightness(target, camera, sun, 0.2) - target - Vector3(0.2 * std::sqrt(0.5), 0.0, 0.0)).norm(),
            1e-9);
  // Full and new target: none.
  EXPECT_LT((centre_of_brightness(target, camera, Vector3(0.0, 1.0, 0.0), 0.2) - target).norm(), 1e-9);
}

TEST(RoeFilter, ABetterServicerOrbitLeavesTheRelativeOrbitAlone) {
  RoeFilter filter;
  filter.begin(kRoe, diagonal_covariance(1.0, 50.0, 5.0));
  const orbit::CartesianState servicer = scene_servicer();
  orbit::CartesianState moved = servicer;
  moved.position_eci += Vector3(1.5, -2.0, 1.0);
  moved.velocity_eci += Vector3(0.002, 0.001, -0.003);
  const auto before = orbit::relative_state_rtn(servicer, filter.target(servicer).value());
  const auto after = orbit::relative_state_rtn(moved, filter.target(moved).value());
  // Metres of the servicer, of a semi-major axis: 3e-7 of 50 km and as much of velocity 4e-7, few times.
  EXPECT_LT((after.position_rtn - before.position_rtn).norm(), 0.1);
  EXPECT_LT((after.velocity_rtn - before.velocity_rtn).norm(), 1e-4);
}

/// A thousand orbits drawn from the covariance, each coasted by itself and seen by itself.
TEST(RoeFilter, CovarianceOfACoastIsThatOfManyOrbits) {
  const Matrix6 covariance = diagonal_covariance(10.0, 1000.0, 100.0);
  RoeFilter filter(without_pushes());
  filter.begin(kRoe, covariance);
  const orbit::CartesianState servicer = scene_servicer();
  const Propagation propagation(scene_start(), scene_earth(), scene_sun());
  constexpr double kCoast_s = 1800.0;
  filter.advance(propagation, servicer, kCoast_s);
  const orbit::CartesianState later = propagation.coast(servicer, kCoast_s);
  const auto chief = orbit::qns_from_cartesian(later).value();

  Noise noise(5);
  constexpr int kOrbits = vbar::test::share_under_sanitizers(2000);
  std::vector<Vector6> roes;
  Vector6 mean = Vector6::Zero();
  for (int k = 0; k < kOrbits; ++k) {
    const Vector6 drawn = kRoe + covariance.diagonal().cwiseSqrt().cwiseProduct(noise.normal6());
    const auto target = propagation.coast(scene_target(servicer, drawn), kCoast_s);
    roes.push_back(orbit::roe_from_qns(chief, orbit::qns_from_cartesian(target).value()));
    mean += roes.back() / kOrbits;
  }
  Matrix6 sampled = Matrix6::Zero();
  for (const Vector6& roe : roes) sampled += (roe - mean) * (roe - mean).transpose() / (kOrbits - 1);
  const math::Cholesky6 factor(filter.roe_covariance());
  ASSERT_TRUE(factor.ok());
  // In the filter's own metric the sampled covariance is the unit matrix, each element within 1/sqrt(n) (times
  // sqrt 2 on the diagonal): 5 sigma.
  Matrix6 whitened;
  for (int c = 0; c < 6; ++c) whitened.col(c) = factor.solve_lower(sampled.col(c));
  for (int c = 0; c < 6; ++c) {
    const Vector6 row = whitened.row(c).transpose();
    whitened.row(c) = factor.solve_lower(row).transpose();
  }
  EXPECT_LT(accuracy::largest_entry(whitened - Matrix6::Identity()), 5.0 * std::sqrt(2.0 / kOrbits)) << whitened;
  EXPECT_LT(factor.solve_lower(mean - filter.roe()).norm(), 5.0 * std::sqrt(6.0 / kOrbits));
}

TEST(RoeFilter, ABurnMovesTheElementsAsTwoStatesSay) {
  RoeFilter filter;
  const Matrix6 covariance = diagonal_covariance(1e-3, 1e-3, 1e-3);
  filter.begin(kRoe, covariance);
  const orbit::CartesianState servicer = scene_servicer();
  const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * Vector3(0.01, 0.3, -0.35);
  const orbit::CartesianState target = scene_target(servicer, kRoe);
  filter.add_servicer_impulse(servicer, dv_eci);
  const orbit::CartesianState after{servicer.position_eci, servicer.velocity_eci + dv_eci};
  const orbit::CartesianState same = filter.target(after).value();
  EXPECT_LT((same.position_eci - target.position_eci).norm(), 1e-6);
  EXPECT_LT((same.velocity_eci - target.velocity_eci).norm(), 1e-9);
  // 0.46 m/s known to 1e-3 is 2/n times that in a da and in a de: 0.87 m (2/n = 1886 s).
  EXPECT_NEAR(kA * std::sqrt(filter.roe_covariance()(0, 0)), 1886.0 * 1e-3 * dv_eci.norm(), 0.02);
}

/// Against Kalman's equations with full matrices, the slopes by differences of the geometry.
TEST(RoeFilter, UpdateIsKalmans) {
  const orbit::CartesianState servicer = scene_servicer();
  const Matrix6 covariance = diagonal_covariance(2.0, 20.0, 3.0);
  RoeFilterSettings settings;
  settings.brightness_offset_m = 0.1;
  settings.gate = 1e9;
  RoeFilter filter(settings);
  filter.begin(kRoe, covariance);
  BearingMeasurement bearing =
      bearing_of(scene_start(), servicer, scene_target(servicer, kRoe), 12.0 * kArcsec, {2e-5, -3e-5});
  bearing.apparent_radius = 1e-5;

  using State = Eigen::Matrix<double, 11, 1>;
  const Matrix3 axes = bearing_axes(bearing.direction_eci, servicer);
  const auto shown = [&](const State& x) {
    const Vector3 target = scene_target(servicer, x.head<6>()).position_eci;
    const Vector3 sight =
        centre_of_brightness(target, servicer.position_eci, scene_sun(), x(8)) - servicer.position_eci;
    return Vector2(axes.topRows<2>() * sight.normalized() + x.tail<2>());
  };
  State mean = State::Zero();
  mean.head<6>() = kRoe;
  mean(8) = 0.1;
  State sigma;
  sigma << covariance.diagonal().cwiseSqrt(), settings.along_track_sigma, settings.from_sun_sigma,
      settings.brightness_offset_sigma_m, settings.bearing_bias_sigma, settings.bearing_bias_sigma;
  Eigen::Matrix<double, 2, 11> h;
  for (int k = 0; k < 11; ++k) {
    const State step = 0.01 * sigma(k) * State::Unit(k);
    h.col(k) = (shown(mean + step) - shown(mean - step)) / (0.02 * sigma(k));
  }
  const Eigen::Matrix<double, 11, 11> p = sigma.cwiseAbs2().asDiagonal();
  const double variance = bearing.sigma * bearing.sigma + 0.25 * 0.25 * 1e-10;
  const Matrix2 s = h * p * h.transpose() + variance * Matrix2::Identity();
  const Eigen::Matrix<double, 11, 2> gain = p * h.transpose() * s.inverse();
  const State expected = mean - gain * shown(mean);
  const Eigen::Matrix<double, 11, 11> rest = p - gain * h * p;

  const BearingUpdate update = filter.take(bearing, servicer, scene_sun());
  ASSERT_TRUE(update.accepted);
  EXPECT_NEAR(update.nis, shown(mean).dot(s.inverse() * shown(mean)), 1e-3 * update.nis);
  for (int k = 0; k < 11; ++k) {
    // The bearing's curvature over a sigma is 1e-4 of its slope.
    EXPECT_NEAR(filter.estimate().mean(k), expected(k), 1e-3 * sigma(k)) << k;
    EXPECT_NEAR(filter.estimate().variance(k), rest(k, k), 1e-3 * p(k, k)) << k;
  }
  EXPECT_LT((update.postfit + shown(expected)).norm(), 1e-3 * update.prefit.norm());
}

TEST(RoeFilter, ABearingThatDoesNotFitChangesNothing) {
  RoeFilter filter;
  const orbit::CartesianState servicer = scene_servicer();
  filter.begin(kRoe, diagonal_covariance(1.0, 20.0, 3.0));
  const Vector6 roe = filter.roe();
  const Matrix6 covariance = filter.roe_covariance();
  BearingMeasurement bearing =
      bearing_of(scene_start(), servicer, scene_target(servicer, kRoe), 10.0 * kArcsec, {1e-3, 0.0});
  EXPECT_FALSE(filter.take(bearing, servicer, scene_sun()).accepted);
  bearing.direction_eci = -bearing.direction_eci;  // behind the camera: nothing may come of it but a refusal
  EXPECT_FALSE(filter.take(bearing, servicer, scene_sun()).accepted);
  bearing.direction_eci.setConstant(NAN);
  EXPECT_FALSE(filter.take(bearing, servicer, scene_sun()).accepted);
  EXPECT_EQ(filter.roe(), roe);
  EXPECT_EQ(filter.roe_covariance(), covariance);
}

TEST(RoeFilter, PredictsTheBearingAndHowWellItIsKnown) {
  RoeFilter filter(without_pushes());
  const orbit::CartesianState servicer = scene_servicer();
  const Vector6 roe = roe_of_metres(0.0, -50000.0, 0.0, 0.0, 0.0, 0.0);
  filter.begin(roe, diagonal_covariance(0.01, 500.0, 0.01));
  const auto prediction = filter.predict(servicer, Vector3::Zero(), scene_sun());
  ASSERT_TRUE(prediction.ok());
  const Vector3 sight = scene_target(servicer, roe).position_eci - servicer.position_eci;
  EXPECT_LT((prediction.value().direction_eci - sight.normalized()).norm(), 1e-5);
  // Along a circle of radius a, 500 m turn the chord by half of 500 m / a; the bias adds 3 arcsec.
  const double turned = 0.5 * 500.0 / kA;
  EXPECT_NEAR(std::sqrt(prediction.value().covariance(0, 0)), std::hypot(turned, 1.5e-5), 0.03 * turned);
}

TEST(RoeFilter, ResetsItselfWhereNoOrbitIsLeft) {
  RoeFilter filter;
  filter.begin(roe_of_metres(0.0, -1000.0, 0.0, 0.0, 0.0, 0.0), Matrix6::Identity());  // 1 rad, e = 1: no orbits
  filter.advance(Propagation(scene_start(), scene_earth(), scene_sun()), scene_servicer(), 60.0);
  EXPECT_FALSE(filter.started());
  EXPECT_EQ(filter.target(scene_servicer()).status(), Status::kNotReady);
}

}  // namespace
}  // namespace vbar::fsw::navigation
