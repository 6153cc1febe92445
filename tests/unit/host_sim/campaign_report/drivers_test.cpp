#include "host_sim/campaign_report/drivers.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::campaign_report::test {
namespace {

using testing::ElementsAre;

Campaign campaign_with(const std::vector<std::string>& keys, const std::vector<std::vector<std::string>>& inputs) {
  Campaign campaign;
  campaign.keys = keys;
  for (const auto& values : inputs) {
    Case& one = campaign.cases.emplace_back();
    one.number = campaign.cases.size() - 1;
    one.inputs = values;
    one.state = State::kComplete;
    one.passed = true;
  }
  return campaign;
}

TEST(Drivers, AreNumbersComponentsOfVectorsAndSwitches) {
  const Campaign campaign = campaign_with({"mass_kg", "axis", "moon", "solver", "same"},
                                          {{"1.5", "[1.0, 0.0, 2.0]", "true", "closed_form", "3"},
                                           {"2e-3", "[0.5, 0.0, -2.0]", "false", "least_squares", "3"}});
  std::vector<std::string> others;
  const std::vector<Driver> found = drivers(campaign, others);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].name, "mass_kg");
  EXPECT_THAT(found[0].values, ElementsAre(1.5, 0.002));
  EXPECT_EQ(found[1].name, "axis[0]");
  EXPECT_EQ(found[2].name, "axis[2]") << "the second component is constant";
  EXPECT_THAT(found[2].values, ElementsAre(2.0, -2.0));
  EXPECT_THAT(found[3].values, ElementsAre(1.0, 0.0));
  EXPECT_THAT(others, ElementsAre("solver", "same"));
}

// Failed cases have no figures, but it is them that an engineer asks about.
TEST(Drivers, FailedCasesCountAsNotPassed) {
  std::vector<std::vector<std::string>> inputs;
  for (int k = 0; k < 30; ++k) inputs.push_back({std::to_string(k)});
  Campaign campaign = campaign_with({"loss"}, inputs);
  for (std::size_t k = 20; k < 30; ++k) campaign.cases[k].state = State::kFailed;
  campaign.cases[0].state = State::kLost;
  campaign.cases[1].passed = false;
  const std::vector<Response> found = responses(campaign, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(std::isnan(found[0].values[0])) << "a lost case shows nothing";
  EXPECT_EQ(found[0].values[1], 1.0);
  EXPECT_EQ(found[0].values[2], 0.0);
  EXPECT_EQ(found[0].values[29], 1.0);
  std::vector<std::string> others;
  const std::vector<Driver> inputs_of = drivers(campaign, others);
  const std::vector<Dependence> all = dependences(inputs_of, found);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_GT(all[0].correlation.rho, 0.6);
  EXPECT_TRUE(all[0].is_significant());
}

}  // namespace
}  // namespace vbar::campaign_report::test
