// Errors, sigmas and consistency figures at selected times.

#include "host_sim/report/samples.h"

#include <gtest/gtest.h>

#include "host_sim/report/extension.h"

namespace vbar::report {
namespace {

using Kind = ConsistencyFigure::Kind;

std::vector<ConsistencyFigure> figures(const RunRecord& /*record*/) {
  return {{3600.0, Kind::kNees, 6.5, 6.0},
          {3600.0, Kind::kNis, 21.0, 20.0},
          {3660.0, Kind::kNees, 5.5, 6.0},
          {3660.0, Kind::kNis, 11.0, 10.0},
          {3670.0, Kind::kNis, 3.0, 0.0}};
}
const Extension kModule{.consistency = figures};
const Extension* const kModules[] = {&kModule};

/// A step a minute from the first hour on; the estimate is off by (1, 2, 2) mm and (0, 3, 4) um/s. The third is
/// invalid.
RunRecord record(std::vector<double> sample_hours) {
  RunRecord record;
  record.extensions = kModules;
  for (int step = 0; step < 4; ++step) {
    TruthRow truth;
    truth.time_s = 3600.0 + 60.0 * step;
    truth.relative_position_rtn = {10.0, 0.0, 0.0};
    record.truth.push_back(truth);
    EstimateRow estimate;
    estimate.time_s = truth.time_s;
    estimate.navigation_valid = step == 2 ? 0 : 1;
    estimate.relative_position_rtn = {10.001, 0.002, 0.002};
    estimate.relative_velocity_rtn = {0.0, 3e-6, 4e-6};
    estimate.sigma_rtn = {0.003, 0.004, 0.012, 1e-6, 2e-6, 2e-6};
    record.estimates.push_back(estimate);
  }
  for (const double hour : sample_hours) record.summary.samples.push_back({.time_h = hour});
  return record;
}

Summary summary_of(const RunRecord& record) {
  Summary summary = record.summary;
  summarise_consistency(record, summary);
  return summary;
}

TEST(Samples, StateTheEstimateOfTheLastStep) {
  const Sample sample = summary_of(record({1.0 + 90.0 / 3600.0})).samples.at(0);  // half a minute after the second step
  EXPECT_NEAR(sample.navigation_error_m.value(), 0.003, 1e-12);
  EXPECT_NEAR(sample.navigation_error_r_m.value(), 0.001, 1e-12);
  EXPECT_NEAR(sample.navigation_velocity_error_mps.value(), 5e-6, 1e-15);
  EXPECT_NEAR(sample.sigma_m.value(), 0.013, 1e-12);
  EXPECT_NEAR(sample.sigma_velocity_mps.value(), 3e-6, 1e-15);
}

TEST(Samples, AreAtTheStepOfTheirOwnTime) {
  RunRecord all = record({1.0 + 60.0 / 3600.0});
  all.estimates[1].relative_position_rtn = {10.0, 0.0, 0.5};
  EXPECT_DOUBLE_EQ(summary_of(all).samples.at(0).navigation_error_m.value(), 0.5);
}

TEST(Samples, HaveNoErrorWithoutAValidEstimate) {
  const Summary summary = summary_of(record({0.5, 1.0 + 120.0 / 3600.0}));
  EXPECT_FALSE(summary.samples.at(0).navigation_error_m) << "before the first step";
  EXPECT_FALSE(summary.samples.at(1).navigation_error_m) << "navigation was invalid";
  EXPECT_FALSE(summary.samples.at(1).sigma_m);
}

TEST(Samples, TakeEachConsistencyFigureOnce) {
  const Summary summary = summary_of(record({1.0, 1.0 + 61.0 / 3600.0, 1.05}));
  EXPECT_EQ(summary.samples.at(0).nees, 6.5);
  EXPECT_EQ(summary.samples.at(0).nis, 21.0);
  EXPECT_EQ(summary.samples.at(0).nis_dimension, 20.0);
  EXPECT_EQ(summary.samples.at(1).nees, 5.5);
  EXPECT_EQ(summary.samples.at(1).nees_dimension, 6.0);
  EXPECT_FALSE(summary.samples.at(2).nees) << "nothing since the sample before";
  EXPECT_FALSE(summary.samples.at(2).nis) << "an update without measurements is none";
}

TEST(Samples, OfTheWholeRunAreMeans) {
  const Summary summary = summary_of(record({}));
  EXPECT_EQ(summary.navigation_nees_dimension, 6.0);
  EXPECT_EQ(summary.navigation_nis, 16.0);
  EXPECT_EQ(summary.navigation_nis_dimension, 15.0);
}

}  // namespace
}  // namespace vbar::report
