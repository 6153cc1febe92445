#include <memory>

#include <gtest/gtest.h>

#include "fsw/measurements/range_source.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::measurements {
namespace {

using namespace measurements::test;
using filter::SolutionStatus;

constexpr int kBias = filter::kAt<RangeBias>;
const Vector6 kRoe = roe_of_metres(0.0, -100.0, 5.0, 8.0, -3.0, 6.0);

double range_of(const filter::RelativeNavigationFilter& filter, const Vector6& roe) {
  return (scene_target(filter.servicer(), roe).position_eci - filter.servicer().position_eci).norm();
}

/// The servicer's orbit known, the target's to `sigma_m` of each a * ROE, off by a tenth of it in each.
std::unique_ptr<filter::RelativeNavigationFilter> filter_with(double sigma_m) {
  auto filter = std::make_unique<filter::RelativeNavigationFilter>();
  filter::FilterSettings settings;
  settings.earth = scene_earth();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  filter->set_states(scene_servicer(), scene_target(scene_servicer(), kRoe));
  if (sigma_m > 0.0) {
    const Vector6 variance = Vector6::Constant(sigma_m * sigma_m / (kA * kA));
    filter->initialize_relative(kRoe + Vector6::Constant(0.1 * sigma_m / kA), variance.asDiagonal(),
                                SolutionStatus::kEstimated);
  }
  return filter;
}

/// Sensitivities against differences of the exact map.
TEST(RangeRows, SensitivityIsThatOfTheGeometry) {
  const auto filter = filter_with(0.01);
  filter::MeasurementBatch& batch = filter->workspace();
  ASSERT_EQ(range_rows(*filter, 100.0, 0.01, batch), Status::kOk);
  const Vector6 roe = filter->roe();
  constexpr double kStep = 1e-8;
  for (int k = 0; k < 6; ++k) {
    const Vector6 step = kStep * Vector6::Unit(k);
    const double slope = (range_of(*filter, roe + step) - range_of(*filter, roe - step)) / (2.0 * kStep);
    EXPECT_NEAR(batch.sensitivity(k, 0) / kA, slope / kA, 1e-5) << k;
  }
  EXPECT_EQ(batch.sensitivity(kBias, 0), 1.0);
  EXPECT_NEAR(batch.residual(0), 100.0 - range_of(*filter, roe), 1e-5);
}

/// A constant bias cannot be told from the range by ranges alone: their sum becomes known, each is known as before.
TEST(RangeAiding, ItsBiasLimitsWhatRangesTell) {
  constexpr double kTrueBias_m = 0.03, kNoise_m = 0.01;
  Noise noise(1);
  const auto filter = filter_with(0.1);
  const double truth_m = range_of(*filter, kRoe);
  RangeAiding aiding;
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(aiding.process(truth_m + kTrueBias_m + kNoise_m * noise.normal(), *filter), RangeEditStatus::kUsed) << k;
  }
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
  const filter::Estimate& estimate = filter->estimate();
  const double range_m = range_of(*filter, filter->roe());
  EXPECT_NEAR(range_m + estimate.mean(kBias), truth_m + kTrueBias_m, 3.0 * kNoise_m / 10.0);
  EXPECT_NEAR(range_m, truth_m, 3.0 * 0.02);
  EXPECT_LT(std::sqrt(estimate.variance(kBias)), 0.02);
  EXPECT_GT(std::sqrt(estimate.variance(kBias)), 0.019);
}

TEST(RangeAiding, ContradictingRangesAreSuspendedAndChangeNothing) {
  Noise noise(2);
  const auto filter = filter_with(0.05);
  const double truth_m = range_of(*filter, kRoe);
  RangeAiding aiding;
  for (int k = 0; k < 10; ++k) aiding.process(truth_m + 0.01 * noise.normal(), *filter);
  const Vector6 roe = filter->roe();
  const Matrix6 covariance = filter->roe_covariance();
  for (int k = 0; k < 10; ++k) EXPECT_EQ(aiding.process(truth_m + 0.5, *filter), RangeEditStatus::kRejected);
  EXPECT_EQ(aiding.aid().state(), AidState::kSuspended);
  EXPECT_EQ(aiding.counters().rejected, 10);
  EXPECT_EQ(filter->roe(), roe);
  EXPECT_EQ(filter->roe_covariance(), covariance);
  // Three that agree resume it.
  EXPECT_EQ(aiding.process(truth_m, *filter), RangeEditStatus::kRejected);
  EXPECT_EQ(aiding.process(truth_m, *filter), RangeEditStatus::kRejected);
  EXPECT_EQ(aiding.process(truth_m, *filter), RangeEditStatus::kUsed);
  EXPECT_EQ(aiding.aid().state(), AidState::kAiding);
}

TEST(RangeAiding, InitialisesNothing) {
  filter::RelativeNavigationFilter filter;
  RangeAiding aiding;
  EXPECT_EQ(aiding.process(100.0, filter), RangeEditStatus::kNone);
  EXPECT_FALSE(filter.has_relative());
}

TEST(RangeAiding, SilenceSuspendsAndAStopRestsTheBias) {
  const auto filter = filter_with(0.05);
  RangeAiding aiding;
  ASSERT_EQ(aiding.process(range_of(*filter, kRoe), *filter), RangeEditStatus::kUsed);
  aiding.check_age(scene_start() + duration_of_seconds(61));
  EXPECT_EQ(aiding.aid().state(), AidState::kSuspended);
  const Matrix6 covariance = filter->roe_covariance();
  aiding.stop(scene_start(), *filter);
  EXPECT_FALSE(filter::is_active<RangeBias>(filter->estimate()));
  EXPECT_EQ(filter->roe_covariance(), covariance);
}

}  // namespace
}  // namespace vbar::fsw::measurements
