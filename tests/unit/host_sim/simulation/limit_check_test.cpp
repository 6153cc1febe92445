#include "host_sim/simulation/limit_check.h"

#include <limits>
#include <sstream>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
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

namespace {

TEST(JunitXml, CountsCasesAndFailuresOfEachSuite) {
  const std::string text =
      junit_xml({{.name = "runs/a", .duration_s = 12.3456, .cases = {{"complete", ""}, {"dv_mps", "too large"}}},
                 {.name = "runs/b", .duration_s = 0.0, .cases = {{"complete", ""}}}});
  std::istringstream input(text);
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(input, tree);
  const auto& suites = tree.get_child("testsuites");
  ASSERT_EQ(suites.count("testsuite"), 2U);
  const auto& first = suites.front().second;
  EXPECT_EQ(first.get<std::string>("<xmlattr>.name"), "runs/a");
  EXPECT_EQ(first.get<int>("<xmlattr>.tests"), 2);
  EXPECT_EQ(first.get<int>("<xmlattr>.failures"), 1);
  EXPECT_EQ(first.get<std::string>("<xmlattr>.time"), "12.346");
  const auto& second = suites.back().second;
  EXPECT_EQ(second.get<int>("<xmlattr>.failures"), 0);
  EXPECT_EQ(second.get<std::string>("testcase.<xmlattr>.name"), "complete");
}

TEST(JunitXml, CarriesEveryCharacterOfANameAndAMessage) {
  const std::string name = "a <\"b\"> & 'c'";
  std::istringstream input(junit_xml({{.name = name, .duration_s = 0.0, .cases = {{name, name}}}}));
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(input, tree);
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.<xmlattr>.name"), name);
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.testcase.failure.<xmlattr>.message"), name);
}

}  // namespace

}  // namespace vbar::check
