#include "host_sim/report/navigation_errors.h"

#include <gtest/gtest.h>

#include "tests/unit/host_sim/report/relative_rows.h"

namespace vbar::report::test {
namespace {

TEST(NavigationErrors, AreEstimateLessTruthOfValidSteps) {
  RunRecord record;
  Vector6 truth = Vector6::Zero();
  truth(1) = -7.0;
  Vector6 estimate = truth;
  estimate(0) = 0.25;
  estimate(5) = -0.5;
  for (const double t : {0.0, 10.0, 20.0}) {
    record.truth.push_back(truth_at(t, truth));
    record.estimates.push_back(estimate_at(t, estimate, 4));
  }
  record.estimates[1].navigation_valid = 0;
  record.estimates.push_back(estimate_at(25.0, estimate, 4));  // no truth of that time
  const std::vector<NavigationError> errors = navigation_errors(record);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].time_s, 20.0);
  EXPECT_EQ(errors[1].position_rtn, (Triple{0.25, 0.0, 0.0}));
  EXPECT_EQ(errors[1].velocity_rtn, (Triple{0.0, 0.0, -0.5}));
}

TEST(NavigationErrors, FirstFixIsTheFirstStepByFixedAmbiguities) {
  RunRecord record;
  EXPECT_FALSE(first_fix(record).has_value());
  const Vector6 zero = Vector6::Zero();
  record.estimates = {estimate_at(0.0, zero, 3), estimate_at(10.0, zero, 4), estimate_at(20.0, zero, 4)};
  EXPECT_EQ(first_fix(record), 10.0);
  record.estimates[1].navigation_valid = 0;
  EXPECT_EQ(first_fix(record), 20.0);
}

}  // namespace
}  // namespace vbar::report::test
