#include "fsw/sources/range_finder/range_aiding.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::sources {
namespace {

using namespace navigation::test;
using trunk::RelativeKnowledge;

constexpr int kBias = trunk::kAt<RangeBias>;
const Vector6 kRoe = roe_of_metres(0.0, -100.0, 5.0, 8.0, -3.0, 6.0);

double range_of(const trunk::Trunk& trunk, const Vector6& roe) {
  return (scene_target(trunk.servicer(), roe).position_eci - trunk.servicer().position_eci).norm();
}

/// The servicer's orbit known, the target's to `sigma_m` of each a * ROE, off by a tenth of it in each.
std::unique_ptr<trunk::Trunk> trunk_with(double sigma_m) {
  auto trunk = std::make_unique<trunk::Trunk>();
  trunk::TrunkSettings settings;
  settings.earth = scene_earth();
  trunk->configure(settings);
  trunk->advance_to(scene_start(), {});
  trunk->set_states(scene_servicer(), scene_target(scene_servicer(), kRoe));
  if (sigma_m > 0.0) {
    const Vector6 variance = Vector6::Constant(sigma_m * sigma_m / (kA * kA));
    trunk->begin_relative(kRoe + Vector6::Constant(0.1 * sigma_m / kA), variance.asDiagonal(),
                          RelativeKnowledge::kEstimated);
  }
  return trunk;
}

/// Sensitivities against differences of the exact map.
TEST(RangeRows, SensitivityIsThatOfTheGeometry) {
  const auto trunk = trunk_with(0.01);
  trunk::MeasurementBatch& batch = trunk->workspace();
  ASSERT_EQ(range_rows(*trunk, 100.0, 0.01, batch), Status::kOk);
  const Vector6 roe = trunk->roe();
  constexpr double kStep = 1e-8;
  for (int k = 0; k < 6; ++k) {
    const Vector6 step = kStep * Vector6::Unit(k);
    const double slope = (range_of(*trunk, roe + step) - range_of(*trunk, roe - step)) / (2.0 * kStep);
    EXPECT_NEAR(batch.sensitivity(k, 0) / kA, slope / kA, 1e-5) << k;
  }
  EXPECT_EQ(batch.sensitivity(kBias, 0), 1.0);
  EXPECT_NEAR(batch.residual(0), 100.0 - range_of(*trunk, roe), 1e-5);
}

/// A constant bias cannot be told from the range by ranges alone: their sum becomes known, each is known as before.
TEST(RangeAiding, ItsBiasLimitsWhatRangesTell) {
  constexpr double kTrueBias_m = 0.03, kNoise_m = 0.01;
  Noise noise(1);
  const auto trunk = trunk_with(0.1);
  const double truth_m = range_of(*trunk, kRoe);
  RangeAiding aiding;
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(aiding.process(truth_m + kTrueBias_m + kNoise_m * noise.normal(), *trunk), RangeEditStatus::kUsed) << k;
  }
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
  const trunk::Estimate& estimate = trunk->estimate();
  const double range_m = range_of(*trunk, trunk->roe());
  EXPECT_NEAR(range_m + estimate.mean(kBias), truth_m + kTrueBias_m, 3.0 * kNoise_m / 10.0);
  EXPECT_NEAR(range_m, truth_m, 3.0 * 0.02);
  EXPECT_LT(std::sqrt(estimate.variance(kBias)), 0.02);
  EXPECT_GT(std::sqrt(estimate.variance(kBias)), 0.019);
}

TEST(RangeAiding, ContradictingRangesAreSuspendedAndChangeNothing) {
  Noise noise(2);
  const auto trunk = trunk_with(0.05);
  const double truth_m = range_of(*trunk, kRoe);
  RangeAiding aiding;
  for (int k = 0; k < 10; ++k) aiding.process(truth_m + 0.01 * noise.normal(), *trunk);
  const Vector6 roe = trunk->roe();
  const Matrix6 covariance = trunk->roe_covariance();
  for (int k = 0; k < 10; ++k) EXPECT_EQ(aiding.process(truth_m + 0.5, *trunk), RangeEditStatus::kRefused);
  EXPECT_EQ(aiding.aid().state(), AidState::kSuspended);
  EXPECT_EQ(aiding.counters().refused, 10);
  EXPECT_EQ(trunk->roe(), roe);
  EXPECT_EQ(trunk->roe_covariance(), covariance);
  // Three that agree resume it.
  EXPECT_EQ(aiding.process(truth_m, *trunk), RangeEditStatus::kRefused);
  EXPECT_EQ(aiding.process(truth_m, *trunk), RangeEditStatus::kRefused);
  EXPECT_EQ(aiding.process(truth_m, *trunk), RangeEditStatus::kUsed);
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
}

TEST(RangeAiding, InitialisesNothing) {
  trunk::Trunk trunk;
  RangeAiding aiding;
  EXPECT_EQ(aiding.process(100.0, trunk), RangeEditStatus::kNone);
  EXPECT_FALSE(trunk.has_relative());
}

TEST(RangeAiding, SilenceSuspendsAndAStopRestsTheBias) {
  const auto trunk = trunk_with(0.05);
  RangeAiding aiding;
  ASSERT_EQ(aiding.process(range_of(*trunk, kRoe), *trunk), RangeEditStatus::kUsed);
  aiding.check_age(scene_start() + duration_of_seconds(61));
  EXPECT_EQ(aiding.aid().state(), AidState::kSuspended);
  const Matrix6 covariance = trunk->roe_covariance();
  aiding.stop(scene_start(), *trunk);
  EXPECT_FALSE(trunk::is_active<RangeBias>(trunk->estimate()));
  EXPECT_EQ(trunk->roe_covariance(), covariance);
}

}  // namespace
}  // namespace vbar::fsw::sources
