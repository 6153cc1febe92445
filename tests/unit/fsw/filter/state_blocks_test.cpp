#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/filter/target_attitude.h"
#include "fsw/math/cholesky.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::filter {

namespace {

using namespace measurements::test;

const Vector6 kRoe = roe_of_metres(-87.0, -50000.0, 30.0, 1000.0, -20.0, 1000.0);

Matrix6 diagonal_covariance(double da, double dl, double rest) {
  Vector6 sigma;
  sigma << da, dl, rest, rest, rest, rest;
  return (sigma / kA).cwiseAbs2().asDiagonal();
}

FilterSettings without_noise() {
  FilterSettings settings;
  settings.earth = scene_earth();
  settings.relative_orbit.acceleration = {.psd = 1e-30, .psd_min = 1e-30, .psd_max = 1e-30};
  settings.relative_orbit.drag.sigma = 1e-15;
  settings.relative_orbit.from_sun.sigma = 1e-15;
  return settings;
}

/// A filter at the start of the scene, with both orbits known.
std::unique_ptr<RelativeNavigationFilter> filter_with(const FilterSettings& settings, const Vector6& roe,
                                                      const Matrix6& covariance) {
  auto filter = std::make_unique<RelativeNavigationFilter>();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  filter->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
  filter->initialize_relative(roe, covariance, SolutionStatus::kEstimated);
  return filter;
}

TEST(RelativeOrbit, ABetterServicerOrbitLeavesItUnchanged) {
  const auto filter = filter_with(without_noise(), kRoe, diagonal_covariance(1.0, 50.0, 5.0));
  const orbit::CartesianState servicer = scene_servicer();
  orbit::CartesianState moved = servicer;
  moved.position_eci += Vector3(1.5, -2.0, 1.0);
  moved.velocity_eci += Vector3(0.002, 0.001, -0.003);
  const auto before = orbit::relative_state_rtn(servicer, scene_target(servicer, filter->roe()));
  const auto after = orbit::relative_state_rtn(moved, scene_target(moved, filter->roe()));
  // Metres of the servicer, of a semi-major axis: 3e-7 of 50 km and as much of velocity 4e-7, few times.
  EXPECT_LT((after.position_rtn - before.position_rtn).norm(), 0.1);
  EXPECT_LT((after.velocity_rtn - before.velocity_rtn).norm(), 1e-4);
}

/// A thousand orbits drawn from the covariance, each coasted by itself.
TEST(RelativeOrbit, CovarianceOfACoastIsThatOfManyOrbits) {
  const Matrix6 covariance = diagonal_covariance(10.0, 1000.0, 100.0);
  const auto filter = filter_with(without_noise(), kRoe, covariance);
  constexpr double kCoast_s = 600.0;
  filter->advance_to(scene_start() + duration_of_seconds(600), {});
  const filter::Propagation propagation(scene_start(), scene_earth(), scene_sun());
  const orbit::CartesianState servicer = scene_servicer();
  const auto chief = orbit::qns_from_cartesian(propagation.coast(servicer, kCoast_s)).value();

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
  const math::Cholesky6 factor(filter->roe_covariance());
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
  EXPECT_LT(factor.solve_lower(mean - filter->roe()).norm(), 5.0 * std::sqrt(6.0 / kOrbits));
}

TEST(RelativeOrbit, ABurnMovesTheElementsAsTwoStatesSay) {
  const auto filter = filter_with({}, kRoe, diagonal_covariance(1e-3, 1e-3, 1e-3));
  const orbit::CartesianState servicer = scene_servicer();
  const Vector3 dv_rtn(0.01, 0.3, -0.35);
  const orbit::CartesianState target = scene_target(servicer, kRoe);
  const std::vector<filter::Burn> burns = {{scene_start(), dv_rtn}};
  filter->advance_to(scene_start() + Duration{1}, burns);  // a burn at the epoch comes after it
  const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * dv_rtn;
  const orbit::CartesianState same = filter->target().value();
  EXPECT_LT((filter->servicer().velocity_eci - servicer.velocity_eci - dv_eci).norm(), 1e-7);
  EXPECT_LT((same.position_eci - target.position_eci).norm(), 2e-5);  // a nanosecond at 7.5 km/s
  EXPECT_LT((same.velocity_eci - target.velocity_eci).norm(), 1e-7);
  // 0.46 m/s known to 1e-3 (and 2 um/s) is 2/n times that in a da and in a de: 0.87 m (2/n = 1886 s).
  EXPECT_NEAR(kA * std::sqrt(filter->roe_covariance()(0, 0)), 1886.0 * (1e-3 * dv_rtn.norm() + 2e-6), 0.02);
  ASSERT_EQ(filter->impulses().size(), 1u);
  EXPECT_EQ(filter->impulses()[0].time, scene_start());
  EXPECT_LT((filter->impulses()[0].dv_eci - dv_eci).norm(), 1e-9);
}

TEST(RelativeOrbit, EmpiricalAccelerationsRestAndBeginWithoutTouchingTheOrbit) {
  const auto filter = filter_with(without_noise(), kRoe, diagonal_covariance(1.0, 50.0, 5.0));
  const Vector6 roe = filter->roe();
  const Matrix6 covariance = filter->roe_covariance();
  filter->relative_orbit().activate_empirical(filter->estimate());
  EXPECT_TRUE(is_active<EmpiricalAcceleration>(filter->estimate()));
  EXPECT_EQ(filter->roe(), roe);
  EXPECT_EQ(filter->roe_covariance(), covariance);
  deactivate_block<EmpiricalAcceleration>(filter->estimate());
  EXPECT_FALSE(is_active<EmpiricalAcceleration>(filter->estimate()));
  EXPECT_EQ(filter->roe_covariance(), covariance);
}

/// 1e-7 m/s^2 radially, constant over ten minutes, against the same acceleration in the propagation of the target.
TEST(RelativeOrbit, AnEmpiricalAccelerationMovesTheMeanAsThePropagationDoes) {
  const auto filter = filter_with(without_noise(), kRoe, diagonal_covariance(1e-3, 1e-3, 1e-3));
  FilterSettings settings = without_noise();
  settings.relative_orbit.empirical = {.sigma = 1e-12, .time_s = estimation::kConstant};
  filter->configure(settings);
  filter->relative_orbit().activate_empirical(filter->estimate());
  filter->estimate().shift(kAt<EmpiricalAcceleration>, 1e-7);
  filter->advance_to(scene_start() + duration_of_seconds(600), {});
  const filter::Propagation propagation(scene_start(), scene_earth(), scene_sun());
  const auto servicer = propagation.coast(scene_servicer(), 600.0);
  const auto pushed =
      propagation.coast(scene_target(scene_servicer(), kRoe), 600.0, {.empirical_rtn = Vector3(1e-7, 0.0, 0.0)});
  const Vector6 expected = orbit::roe_of_target(servicer, pushed).value();
  const auto still = propagation.coast(scene_target(scene_servicer(), kRoe), 600.0);
  const Vector6 without = orbit::roe_of_target(servicer, still).value();
  EXPECT_LT((filter->roe() - expected).norm(), 1e-3 * (expected - without).norm());
}

TEST(RelativeNavigationFilter, DiscardsTheRelativeOrbitAloneWhereNoOrbitIsLeft) {
  // 1 rad, e = 1: no orbits.
  const auto filter =
      filter_with(without_noise(), roe_of_metres(0.0, -1000.0, 0.0, 0.0, 0.0, 0.0), Matrix6::Identity());
  filter->advance_to(scene_start() + duration_of_seconds(60), {});
  EXPECT_EQ(filter->solution_status(), SolutionStatus::kNone);
  EXPECT_EQ(filter->target().status(), Status::kNotReady);
  EXPECT_EQ(filter->failures(), 1);
  EXPECT_TRUE(filter->absolute_orbit().started());
}

/// Blocks of other sensors are activated, propagated and deactivated beside the orbit: its bits stay.
TEST(RelativeNavigationFilter, OtherBlocksLeaveTheBitsOfTheOrbit) {
  const auto alone = filter_with(without_noise(), kRoe, diagonal_covariance(1.0, 50.0, 5.0));
  const auto beside = filter_with(without_noise(), kRoe, diagonal_covariance(1.0, 50.0, 5.0));
  beside->initialize_attitude({}, 0.01 * Matrix6::Identity());
  initialize_block<measurements::CameraMounts>(beside->estimate(), {.sigma = 1e-4});
  beside->advance_to(scene_start() + duration_of_seconds(20), {});
  alone->advance_to(scene_start() + duration_of_seconds(20), {});
  EXPECT_EQ(alone->roe(), beside->roe());
  EXPECT_EQ(alone->roe_covariance(), beside->roe_covariance());
  beside->deactivate_attitude();
  deactivate_block<measurements::CameraMounts>(beside->estimate());
  for (int k = kOrbitSize; k < State::kSize; ++k) EXPECT_TRUE(beside->estimate().is_inactive(k)) << k;
  EXPECT_EQ(alone->roe_covariance(), beside->roe_covariance());
}

}  // namespace

namespace {

constexpr double kTurnSigma = 1e-3;
constexpr double kRateSigma = 1e-5;

/// A filter at the start of the scene with a target that does not rotate; its inertia is a sphere's: no torque.
std::unique_ptr<RelativeNavigationFilter> filter_with(const FilterSettings& settings) {
  auto filter = std::make_unique<RelativeNavigationFilter>();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  const Vector6 roe = roe_of_metres(0.0, -10.0, 0.0, 0.0, 0.0, 0.0);
  filter->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
  Vector6 variance;
  variance.head<3>().setConstant(kTurnSigma * kTurnSigma);
  variance.tail<3>().setConstant(kRateSigma * kRateSigma);
  filter->initialize_attitude({}, variance.asDiagonal());
  return filter;
}

/// Double integrator with white angular acceleration: rate variance q t, rotation variance q t^3 / 3.
void expect_growth(const FilterSettings& settings, double psd) {
  const auto filter = filter_with(settings);
  constexpr double kCoast_s = 600.0;
  filter->advance_to(scene_start() + duration_of_seconds(static_cast<std::int64_t>(kCoast_s)), {});
  const Matrix6 covariance = attitude_covariance(filter->estimate());
  const double rate = kRateSigma * kRateSigma + psd * kCoast_s;
  const double turn = kTurnSigma * kTurnSigma + kRateSigma * kRateSigma * kCoast_s * kCoast_s +
                      psd * kCoast_s * kCoast_s * kCoast_s / 3.0;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(covariance(3 + axis, 3 + axis) / rate, 1.0, 0.01) << psd;
    EXPECT_NEAR(covariance(axis, axis) / turn, 1.0, 0.01) << psd;
  }
}

TEST(TargetAttitude, ProcessNoiseIsThatOfTheSettings) {
  FilterSettings settings;
  expect_growth(settings, 1e-11);  // as by default
  settings.attitude.angular_acceleration = {.psd = 3e-12, .psd_min = 1e-12, .psd_max = 1e-11};
  expect_growth(settings, 3e-12);
}

TEST(TargetAttitude, SettingsOfOtherBlocksKeepTheAdaptedNoise) {
  FilterSettings settings;
  const auto filter = filter_with(settings);
  filter::AdaptiveNoise& noise = filter->attitude().noise();
  for (int k = 0; k <= filter::AdaptiveNoise::kWindow; ++k) noise.add(Vector2::Constant(k % 2 == 0 ? 1.0 : -1.0));
  const double adapted = noise.psd();
  EXPECT_LT(adapted, settings.attitude.angular_acceleration.psd);
  settings.burn_sigma *= 2.0;
  filter->configure(settings);
  EXPECT_EQ(filter->attitude().noise().psd(), adapted);
}

}  // namespace

}  // namespace vbar::fsw::filter
