#include "host_sim/check/limit_check.h"

#include <limits>

#include <gtest/gtest.h>

namespace vbar::check {
namespace {

using mission::Limit;

const std::vector<std::pair<std::string, double>> kNumbers{{"waypoints.10.navigation_error_m", 0.02},
                                                           {"dv_mps", 3.5},
                                                           {"health.nis", std::numeric_limits<double>::quiet_NaN()}};

LimitResult result_of(const Limit& limit) {
  return check_limits(std::vector{limit}, kNumbers).front();
}

TEST(LimitCheck, HoldsAtTheLimitItself) {
  EXPECT_TRUE(result_of({"waypoints.10.navigation_error_m", 0.02, {}}).met);
  EXPECT_TRUE(result_of({"dv_mps", {}, 3.5}).met);
  EXPECT_TRUE(result_of({"dv_mps", 3.5, 3.5}).met);
}

TEST(LimitCheck, StatesTheNumberAndTheLimitThatItMisses) {
  const LimitResult above = result_of({"waypoints.10.navigation_error_m", 0.019, {}});
  EXPECT_FALSE(above.met);
  EXPECT_EQ(above.missed, "waypoints.10.navigation_error_m is 0.02, not at most 0.019");
  EXPECT_EQ(result_of({"dv_mps", {}, 4.0}).missed, "dv_mps is 3.5, not at least 4");
  EXPECT_EQ(result_of({"dv_mps", 3.0, 1.0}).missed, "dv_mps is 3.5, not 1 to 3");
}

TEST(LimitCheck, MissesWhatIsMissingAndWhatIsNotANumber) {
  const LimitResult missing = result_of({"waypoints.11.navigation_error_m", 1.0, {}});
  EXPECT_FALSE(missing.met);
  EXPECT_FALSE(missing.value);
  EXPECT_EQ(missing.missed,
            "the summary has no number waypoints.11.navigation_error_m; did you mean waypoints.10.navigation_error_m?");
  EXPECT_FALSE(result_of({"health.nis", 1e300, {}}).met);
  EXPECT_FALSE(result_of({"health.nis", {}, -1e300}).met);
}

TEST(LimitCheck, KeepsTheOrderOfTheLimits) {
  const auto results = check_limits(std::vector<Limit>{{"dv_mps", 4.0, {}}, {"nothing", 1.0, {}}}, kNumbers);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].limit.key, "dv_mps");
  EXPECT_TRUE(results[0].met);
  EXPECT_EQ(results[1].missed, "the summary has no number nothing");
}

}  // namespace
}  // namespace vbar::check
