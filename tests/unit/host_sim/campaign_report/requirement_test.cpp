// Requirements of a campaign: statistics of known figures, bounds of published tables, and no case that vanishes.

#include "host_sim/campaign_report/requirement.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::campaign_report::test {

namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kKey = "waypoints.10.navigation_error_m";

/// Cases with the figures 1 mm, 2 mm, ..., in an order that is not theirs; all achieved.
Campaign campaign_of(std::size_t cases) {
  Campaign campaign;
  Figure figure{kKey, {}};
  for (std::size_t k = 0; k < cases; ++k) {
    Case one;
    one.number = k;
    one.seed = std::to_string(1000 + k);
    one.state = State::kComplete;
    one.passed = true;
    one.verdict = "achieved";
    campaign.cases.push_back(one);
    figure.values.push_back(static_cast<double>((k * 37) % cases + 1) / 1000.0);
  }
  campaign.figures.push_back(figure);
  return campaign;
}

Requirement figure_requirement(Statistic statistic, std::optional<double> most, std::optional<double> least = {}) {
  Requirement requirement;
  requirement.statistic = statistic;
  requirement.key = kKey;
  requirement.most = most;
  requirement.least = least;
  return requirement;
}

Requirement percentile_requirement(double percentile, std::optional<double> most, std::optional<double> least = {},
                                   std::optional<double> confidence = {}) {
  Requirement requirement = figure_requirement(Statistic::kPercentile, most, least);
  requirement.percentile = percentile;
  requirement.confidence = confidence;
  return requirement;
}

Requirement share_requirement(std::vector<std::string> verdicts, std::optional<double> most,
                              std::optional<double> least = {}) {
  Requirement requirement;
  requirement.statistic = Statistic::kShare;
  requirement.verdicts = std::move(verdicts);
  requirement.most = most;
  requirement.least = least;
  requirement.confidence = 0.95;
  return requirement;
}

JudgedRequirement judged(Campaign campaign, const Requirement& requirement) {
  campaign.requirements = {requirement};
  return judge_requirements(campaign, "night's work").front();
}

TEST(Requirement, IsOnAStatisticOfAllCases) {
  const Campaign campaign = campaign_of(101);  // 1 mm to 101 mm
  const auto value_of_statistic = [&](const Requirement& requirement) { return judged(campaign, requirement).value; };
  EXPECT_EQ(value_of_statistic(figure_requirement(Statistic::kMedian, 1.0)), 51e-3);
  EXPECT_NEAR(*value_of_statistic(figure_requirement(Statistic::kMean, 1.0)), 51e-3, 1e-12);
  EXPECT_EQ(value_of_statistic(figure_requirement(Statistic::kWorst, 1.0)), 101e-3);
  EXPECT_EQ(value_of_statistic(figure_requirement(Statistic::kWorst, {}, 0.0)), 1e-3);
  EXPECT_EQ(value_of_statistic(percentile_requirement(90.0, 1.0)), 91e-3) << "the first that is not below 90 %";
  EXPECT_TRUE(judged(campaign, figure_requirement(Statistic::kMedian, 51e-3)).met);
  EXPECT_FALSE(judged(campaign, figure_requirement(Statistic::kMedian, 50.9e-3)).met);
  EXPECT_TRUE(judged(campaign, figure_requirement(Statistic::kMedian, {}, 51e-3)).met);
  EXPECT_FALSE(judged(campaign, figure_requirement(Statistic::kWorst, {}, 1.1e-3)).met);
}

TEST(Requirement, NamesItsWorstCase) {
  const Campaign campaign = campaign_of(101);
  const JudgedRequirement most = judged(campaign, figure_requirement(Statistic::kMedian, 0.01));
  ASSERT_TRUE(most.worst);
  EXPECT_EQ(campaign.figures[0].values[most.worst->number], 101e-3);
  EXPECT_EQ(most.worst->value, 101e-3);
  EXPECT_EQ(most.worst->seed, std::to_string(1000 + most.worst->number));
  EXPECT_EQ(most.worst->command, "vbar campaign rerun 'night'\\''s work' " + std::to_string(most.worst->number));
  EXPECT_THAT(most.sentence, AllOf(HasSubstr("requirement not met: the median of waypoints.10.navigation_error_m over "
                                             "101 cases is 51.0 mm; at most 10.0 mm required"),
                                   HasSubstr("seed " + most.worst->seed)));
  const JudgedRequirement least = judged(campaign, figure_requirement(Statistic::kMedian, {}, 0.01));
  EXPECT_EQ(campaign.figures[0].values[least.worst->number], 1e-3);
}

// Conover, Practical Nonparametric Statistics: of 100 values at most 89 lie below the 95th percentile with a
// probability of 0.0115, at most 90 with 0.0282, so that its two-sided 95 % bounds are the 90th and the largest. 72
// values are the fewest of which it has an upper bound: 0.95^72 < 0.025 < 0.95^71.
TEST(Requirement, OnAPercentileIsJudgedByItsBound) {
  const Campaign campaign = campaign_of(100);
  const JudgedRequirement upper = judged(campaign, percentile_requirement(95.0, 99e-3, {}, 0.95));
  EXPECT_EQ(upper.value, 95e-3);
  EXPECT_EQ(upper.bound, 100e-3);
  EXPECT_FALSE(upper.met) << "its estimate keeps the limit, its bound does not";
  EXPECT_TRUE(judged(campaign, percentile_requirement(95.0, 99e-3)).met);
  EXPECT_FALSE(judged(campaign, percentile_requirement(95.0, 99e-3)).bound);
  EXPECT_TRUE(judged(campaign, percentile_requirement(95.0, 100e-3, {}, 0.95)).met);
  const JudgedRequirement lower = judged(campaign, percentile_requirement(95.0, {}, 90e-3, 0.95));
  EXPECT_EQ(lower.bound, 90e-3);
  EXPECT_TRUE(lower.met);
  EXPECT_FALSE(judged(campaign, percentile_requirement(95.0, {}, 91e-3, 0.95)).met);

  const JudgedRequirement few = judged(campaign_of(71), percentile_requirement(95.0, 1.0, {}, 0.95));
  EXPECT_FALSE(few.met);
  EXPECT_FALSE(few.bound);
  EXPECT_THAT(few.sentence, HasSubstr("too few cases for a bound at 95 % confidence, two-sided: 72 are needed"));
  EXPECT_TRUE(judged(campaign_of(72), percentile_requirement(95.0, 1.0, {}, 0.95)).met);
  EXPECT_THAT(judged(campaign_of(71), percentile_requirement(5.0, {}, 0.0, 0.95)).sentence, HasSubstr("72 are needed"));
}

// Clopper and Pearson (1934), 95 % two-sided, as in published tables: 20 of 20 show 83.16 %, 99 of 100 94.55 %.
TEST(Requirement, OnAShareIsJudgedByItsBound) {
  Campaign campaign = campaign_of(20);
  EXPECT_NEAR(*judged(campaign, share_requirement({"achieved"}, {}, 0.5)).bound, 0.8316, 5e-5);
  EXPECT_TRUE(judged(campaign, share_requirement({"achieved"}, {}, 0.83)).met);
  EXPECT_FALSE(judged(campaign, share_requirement({"achieved"}, {}, 0.84)).met);
  EXPECT_NEAR(*judged(campaign, share_requirement({"unsafe"}, 0.5)).bound, 1.0 - 0.8316, 5e-5);
  EXPECT_TRUE(judged(campaign, share_requirement({"unsafe"}, 0.17)).met);
  EXPECT_FALSE(judged(campaign, share_requirement({"unsafe"}, 0.16)).met);
  campaign = campaign_of(100);
  campaign.cases[42].verdict = "missed";
  const JudgedRequirement one_missed = judged(campaign, share_requirement({"achieved"}, {}, 0.9));
  EXPECT_NEAR(*one_missed.bound, 0.9455, 5e-5);
  EXPECT_EQ(one_missed.value, 0.99);
  EXPECT_EQ(one_missed.worst->number, 42U);
  EXPECT_EQ(judged(campaign, share_requirement({"achieved", "missed"}, {}, 0.9)).value, 1.0);
  EXPECT_EQ(judged(campaign, share_requirement({"missed"}, 0.1)).worst->number, 42U);
}

TEST(Requirement, OnThePassRateIsJudgedByItsBound) {
  Campaign campaign = campaign_of(20);
  EXPECT_TRUE(judged(campaign, Requirement::pass_rate(0.83, 0.95)).met);
  EXPECT_FALSE(judged(campaign, Requirement::pass_rate(0.84, 0.95)).met);
  EXPECT_EQ(judged(campaign, Requirement::pass_rate(0.83, 0.95)).sentence,
            "requirement met: 20 of 20 cases passed, a pass rate of at least 83.16 % at 95 % confidence, two-sided; "
            "83.00 % required");
  campaign = campaign_of(100);
  for (const State state : {State::kFailed, State::kVoid, State::kNotBegun, State::kLost}) {
    campaign.cases[7].state = state;
    const JudgedRequirement rate = judged(campaign, Requirement::pass_rate(0.9, 0.95));
    EXPECT_NEAR(*rate.bound, 0.9455, 5e-5) << "counts as not passed";
    EXPECT_TRUE(rate.met);
    EXPECT_EQ(rate.worst->number, 7U);
  }
}

TEST(Requirement, HasNoBoundOfALatinHypercube) {
  Campaign campaign = campaign_of(100);
  campaign.is_independent = false;
  for (const Requirement& requirement : {Requirement::pass_rate(0.5, 0.95), share_requirement({"achieved"}, {}, 0.5),
                                         percentile_requirement(50.0, 1.0, {}, 0.95)}) {
    const JudgedRequirement one = judged(campaign, requirement);
    EXPECT_FALSE(one.met);
    EXPECT_FALSE(one.bound);
    EXPECT_THAT(one.sentence, HasSubstr("Latin hypercube"));
  }
  EXPECT_TRUE(judged(campaign, figure_requirement(Statistic::kMedian, 1.0)).met);
}

// Whatever keeps a case from having a value, it is counted, named, and must be allowed.
TEST(Requirement, LosesNoCase) {
  const auto without_value = [](const std::function<void(Campaign&)>& change) {
    Campaign campaign = campaign_of(100);
    change(campaign);
    return campaign;
  };
  const auto in_state = [&](State state) {
    return without_value([state](Campaign& campaign) { campaign.cases[7].state = state; });
  };
  const Campaign nan = without_value([](Campaign& campaign) { campaign.figures[0].values[7] = kNothing; });
  for (const Campaign& campaign :
       {nan, in_state(State::kVoid), in_state(State::kFailed), in_state(State::kOverTime), in_state(State::kLost),
        in_state(State::kKilled), in_state(State::kFlying), in_state(State::kNotBegun)}) {
    for (const Requirement& strict :
         {figure_requirement(Statistic::kMedian, 1.0), figure_requirement(Statistic::kMean, 1.0),
          figure_requirement(Statistic::kWorst, 1.0), percentile_requirement(50.0, 1.0)}) {
      const JudgedRequirement refused = judged(campaign, strict);
      EXPECT_FALSE(refused.met);
      EXPECT_EQ(refused.cases, 99U);
      EXPECT_THAT(refused.missing, ElementsAre(7U));
      EXPECT_THAT(refused.sentence, HasSubstr("1 of 100 cases has no value (case 7), 0 allowed"));
      Requirement lenient = strict;
      lenient.allow_missing = 1;
      EXPECT_TRUE(judged(campaign, lenient).met);
      EXPECT_THAT(judged(campaign, lenient).sentence, HasSubstr("1 of 100 cases has no value (case 7), 1 allowed"));
    }
  }
  const JudgedRequirement unknown = judged(without_value([](Campaign& campaign) { campaign.figures.clear(); }),
                                           figure_requirement(Statistic::kMedian, 1.0));
  EXPECT_FALSE(unknown.met);
  EXPECT_THAT(unknown.sentence,
              AllOf(HasSubstr("results.csv has no column waypoints.10"), HasSubstr("100 of 100 cases")));
  EXPECT_THAT(unknown.sentence, HasSubstr("(cases 0, 1, 2, 3, 4, ...)"));
}

// A failed flight is a verdict on the system; one that was not flown to an end is none, and counts against either
// limit.
TEST(Requirement, CountsACaseWithoutAVerdictAgainstAShare) {
  for (const State state : {State::kVoid, State::kLost, State::kKilled, State::kNotBegun}) {
    Campaign campaign = campaign_of(100);
    campaign.cases[7].state = state;
    campaign.cases[7].verdict.clear();
    const JudgedRequirement refused = judged(campaign, share_requirement({"achieved"}, {}, 0.9));
    EXPECT_FALSE(refused.met);
    EXPECT_NEAR(*refused.bound, 0.9455, 5e-5);
    EXPECT_THAT(refused.missing, ElementsAre(7U));
    EXPECT_THAT(refused.sentence, HasSubstr("1 of 100 cases has no verdict (case 7), 0 allowed"));
    Requirement lenient = share_requirement({"achieved"}, {}, 0.9);
    lenient.allow_missing = 1;
    EXPECT_TRUE(judged(campaign, lenient).met);
    Requirement rare = share_requirement({"unsafe"}, 0.5);
    rare.allow_missing = 1;
    EXPECT_NEAR(*judged(campaign, rare).bound, 1.0 - 0.9455, 5e-5) << "it may have been unsafe";
    EXPECT_EQ(judged(campaign, rare).value, 0.0);
  }
  Campaign campaign = campaign_of(100);
  campaign.cases[7].state = State::kFailed;
  campaign.cases[7].verdict.clear();
  EXPECT_TRUE(judged(campaign, share_requirement({"achieved"}, {}, 0.94)).met) << "counted as not achieved";
  EXPECT_FALSE(judged(campaign, share_requirement({"achieved"}, {}, 0.95)).met);
  EXPECT_NEAR(*judged(campaign, share_requirement({"unsafe"}, 0.5)).bound, 1.0 - 0.9455, 5e-5);
}

TEST(Requirement, StandsInJsonAsItWasStated) {
  Requirement requirement = percentile_requirement(99.7, 0.045, {}, 0.9);
  requirement.allow_missing = 3;
  requirement.paper = "table_4.waypoint_10.navigation";
  const report::Json json{{"require", report::Json::array({json_of(requirement),
                                                           json_of(share_requirement({"achieved", "missed"}, {}, 0.9)),
                                                           json_of(Requirement::pass_rate(0.95, 0.9))})}};
  const std::vector<Requirement> read = requirements_of({json, "campaign.json"});
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t k = 0; k < read.size(); ++k) EXPECT_EQ(json_of(read[k]), json["require"][k]);
  EXPECT_EQ(read[0].paper, requirement.paper);
  EXPECT_EQ(read[0].most, 0.045);
  EXPECT_THAT(read[1].verdicts, ElementsAre("achieved", "missed"));

  const report::Json old{{"require", {{"pass_rate_at_least", 0.95}, {"confidence", 0.9}}}};
  EXPECT_EQ(json_of(requirements_of({old, "campaign.json"}).at(0)), json["require"][2]) << "as older versions wrote it";
}

TEST(CampaignResults, HoldEveryRequirementAndEveryCase) {
  Campaign campaign = campaign_of(10);
  campaign.commit = "4c048e93e2a1";
  campaign.cases[3].state = State::kVoid;
  campaign.cases[3].verdict.clear();
  campaign.cases[3].passed.reset();
  campaign.requirements = {figure_requirement(Statistic::kWorst, 5e-3), share_requirement({"achieved"}, {}, 0.1)};
  const report::Json json = report::Json::parse(results_json(campaign, judge_requirements(campaign, "out")));
  EXPECT_EQ(json["commit"], "4c048e93e2a1");
  EXPECT_EQ(json["cases"], 10);
  EXPECT_EQ(json["states"]["void"], 1);
  EXPECT_EQ(json["verdicts"]["achieved"], 9);
  EXPECT_EQ(json["passed"], 9);
  EXPECT_EQ(json["requirements_met"], false);
  const report::Json& worst = json["requirements"][0];
  EXPECT_EQ(worst["value"], 10e-3);
  EXPECT_EQ(worst["met"], false);
  EXPECT_EQ(worst["cases"], 9);
  EXPECT_EQ(worst["missing"], report::Json::array({3}));
  EXPECT_THAT(worst["worst"]["command"].get<std::string>(), HasSubstr("vbar campaign rerun out "));
  EXPECT_TRUE(worst["bound"].is_null());
}

}  // namespace

}  // namespace vbar::campaign_report::test
