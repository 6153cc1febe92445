#include "host_sim/campaign_report/page.h"

#include <cmath>
#include <fstream>
#include <random>
#include <regex>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign_report/quantity.h"
#include "host_sim/campaign_report/statistics.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::campaign_report::test {

namespace {

using testing::HasSubstr;
using testing::Not;

class CampaignPage : public report::test::ScratchFolder {
 protected:
  [[nodiscard]] std::string page_of(const SyntheticCampaign& synthetic) const {
    write_synthetic_campaign(scratch_ / "night's work", synthetic);
    return page();
  }
  [[nodiscard]] std::string page() const {
    campaign::write_page(scratch_ / "night's work");
    return content(scratch_ / "night's work" / "campaign.html");
  }
  [[nodiscard]] std::filesystem::path results() const { return scratch_ / "night's work" / "results.csv"; }

  [[nodiscard]] std::string complaints() const {
    const auto output =
        report::test::output_of("python3 " + vbar::tests::source_path("tests/unit/host_sim/report/check_page.py") +
                                " \"" + (scratch_ / "night's work" / "campaign.html").string() + "\"");
    return output.status == 0 ? output.text : "check_page.py failed: " + output.text;
  }
};

TEST_F(CampaignPage, ShowsEverySection) {
  const std::string html = page_of({.cases = 300, .is_swept = true, .failed_share = 0.1});
  for (const char* const heading :
       {"Requirements", "Pass rates", "Distributions", "Miss distances", "Consistency of the filter",
        "What drives the figures", "Worst cases", "Failures", "Time and processors"})
    EXPECT_THAT(html, HasSubstr("<h2>" + std::string(heading) + "</h2>"));
  EXPECT_EQ(complaints(), "");
}

// 10,000 cases: at most 2 MB. Seconds are measured in tests/bench, as they depend on the computer.
TEST_F(CampaignPage, OfTenThousandCasesIsSmall) {
  const std::string html = page_of({.cases = 10000, .failed_share = 0.02});
  EXPECT_LE(html.size(), 2'000'000U);
  EXPECT_THAT(html, HasSubstr("10,000 cases"));
  EXPECT_EQ(complaints(), "");
}

TEST_F(CampaignPage, IsTheSameForTheSameFiles) {
  const std::string html = page_of({.cases = 60, .failed_share = 0.1});
  EXPECT_EQ(page(), html);
  std::vector<std::string> lines;
  std::ifstream stream(results());
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  stream.close();
  std::string reversed = lines.front() + "\n";
  for (std::size_t k = lines.size() - 1; k > 0; --k) reversed += lines[k] + "\n";
  write(results(), reversed);
  EXPECT_EQ(page(), html) << "whatever the order of the rows";
}

// What is missing must be seen first.
TEST_F(CampaignPage, CasesWithoutAResultStandInTheFirstLine) {
  const std::string html = page_of({.cases = 500, .failed_share = 0.3});
  const std::size_t end = html.find("</p>");
  const std::string first = html.substr(0, end);
  for (const char* const state : {" failed<", " over time<", " lost<", " void<", " not flown to an end<"})
    EXPECT_THAT(first, HasSubstr(state));
  EXPECT_THAT(html, HasSubstr("cases are without figures"));
  EXPECT_THAT(html, HasSubstr("the spacecraft collided"));
  EXPECT_EQ(complaints(), "");
}

TEST_F(CampaignPage, FailedCasesHaveNotPassedAndKilledOnesAreNotCounted) {
  write_synthetic_campaign(scratch_ / "night's work", {.cases = 4, .epochs = 0});
  std::string text = content(results());
  const auto change = [&](const std::string& number, const std::string& state) {
    text = std::regex_replace(text, std::regex("\n(" + number + ",[^\n]*),complete,[a-z]+,1,[^\n]*"),
                              "\n$1," + state + ",,,,,1,h,p,1,1,,,," + std::string(6, ','));
  };
  change("1", "failed");
  change("2", "killed");
  write(results(), text);
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("passed, 2 of 3 cases"));
  EXPECT_THAT(html,
              HasSubstr("Verdicts on the mission: <span class=\"\">1 achieved</span>, <span class=\"bad\">1 missed"));
  EXPECT_THAT(html, HasSubstr("4 cases: 2 complete (2 passed), <span class=\"bad\">1 failed</span>"));
}

TEST_F(CampaignPage, TheWorstCasesComeWithTheirCommand) {
  const std::string html = page_of({.cases = 100});
  EXPECT_THAT(html, HasSubstr("<code>vbar campaign rerun 'night'\\''s work' ")) << "as a shell reads it";
}

TEST_F(CampaignPage, OfTwentyCasesDoesNotStateWhatTwentyCannotShow) {
  const std::string html = page_of({.cases = 20});
  EXPECT_THAT(html, HasSubstr("open (72 needed)"));
  EXPECT_THAT(html, HasSubstr("open (1228 needed)"));
}

TEST_F(CampaignPage, RejectsAFilterThatClaimsHalfOfItsErrors) {
  EXPECT_THAT(page_of({.cases = 100}), Not(HasSubstr(">rejected<")));
  EXPECT_THAT(page_of({.cases = 100, .sigma_scale = 0.5}), HasSubstr(">rejected<"));
}

TEST_F(CampaignPage, NamesTimesWithoutFigures) {
  write_synthetic_campaign(scratch_ / "night's work", {.cases = 20, .epochs = 3});
  const auto json = scratch_ / "night's work" / "campaign.json";
  write(json, std::regex_replace(content(json), std::regex("\"samples_h\": \\["), "\"samples_h\": [12.5, 13, "));
  EXPECT_THAT(page(), HasSubstr("No case has figures at 12.5, 13 h."));
}

TEST_F(CampaignPage, FindsWhatDrivesTheError) {
  const std::string html = page_of({.cases = 400});
  const std::size_t drivers = html.find("<h2>What drives the figures</h2>");
  EXPECT_THAT(html.substr(drivers),
              HasSubstr("<td>spacecraft.servicer.sensors.gnss.link_budget.lna_noise_figure_db</td>"
                        "<td>waypoints.10.navigation_error_m</td>"));
  EXPECT_THAT(html,
              HasSubstr("Without a significant correlation: spacecraft.servicer.mass_kg, spacecraft.target.mass_kg."));
}

TEST_F(CampaignPage, HasNoBoundsWhereCasesAreNotIndependent) {
  const std::string html = page_of({.cases = 50, .is_independent = false});
  EXPECT_THAT(html, HasSubstr("not independent draws"));
  EXPECT_THAT(html, Not(HasSubstr("lower bound, 95 % two-sided")));
  EXPECT_EQ(complaints(), "");
}

TEST_F(CampaignPage, OfACampaignThatHasNotBegunHasNoFigures) {
  const std::string html = page_of({.cases = 30, .failed_share = 1.0});
  EXPECT_THAT(html, Not(HasSubstr("<h2>Distributions</h2>")));
  EXPECT_EQ(complaints(), "");
}

TEST_F(CampaignPage, StaysWhereTheFilesAreWrong) {
  const std::string html = page_of({.cases = 20});
  write(results(), "case\n1\n");
  EXPECT_THROW(campaign::write_page(scratch_ / "night's work"), std::runtime_error);
  EXPECT_EQ(content(scratch_ / "night's work" / "campaign.html"), html);
}

TEST(DistributionSteps, AreAtMostThatManyAndHoldBothEnds) {
  std::vector<double> sorted;
  for (int k = 1; k <= 10007; ++k) sorted.push_back(k);
  const std::vector<report::Point> steps = distribution_steps(sorted, 500);
  ASSERT_EQ(steps.size(), 500U);
  EXPECT_EQ(steps.back().x, 10007.0);
  EXPECT_EQ(steps.back().y, 1.0);
  for (const report::Point& step : steps) EXPECT_NEAR(step.y, step.x / 10007.0, 1e-15) << "on the whole function";
  EXPECT_EQ(distribution_steps({1.0, 2.0}, 500).size(), 2U);
}

}  // namespace

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

namespace {

constexpr double kConfidence = 0.95;
constexpr Plane kPlane{"RN", 0, 2};

// Of a circular Gaussian without bias: CEP is 1.1774 sigma, R95 2.4477 sigma (Rayleigh distribution).
TEST(Miss, RadiiOfACircularGaussian) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(0.0, 3.0);
  VectorError error;
  for (int k = 0; k < 4000; ++k) error.errors_rtn_m.push_back({normal(engine), 1e3, normal(engine)});
  const PlaneMiss miss = miss_in(kPlane, error, kConfidence);
  ASSERT_TRUE(miss.cep_m.estimate && miss.r95_m.estimate && miss.cep_m.lower && miss.r95_m.upper);
  // Standard errors of the two quantiles of 4000 values: 1.3 and 1.5 % of themselves; four of them.
  EXPECT_NEAR(*miss.cep_m.estimate, 1.1774 * 3.0, 0.2);
  EXPECT_NEAR(*miss.r95_m.estimate, 2.4477 * 3.0, 0.44);
  EXPECT_LT(*miss.cep_m.lower, *miss.cep_m.estimate);
  EXPECT_GT(*miss.r95_m.upper, *miss.r95_m.estimate);
  EXPECT_NEAR(miss.sigma_m[0], 3.0, 0.2);
  EXPECT_NEAR(miss.sigma_m[1], 3.0, 0.2);
}

// Four cases on an ellipse about (10, 20), with semi-axes along (3, 4) / 5 and across it: covariance by hand.
TEST(Miss, EllipseOfTheSampleCovariance) {
  VectorError error;
  for (const auto& [along, across] : {std::pair{5.0, 0.0}, {-5.0, 0.0}, {0.0, 2.0}, {0.0, -2.0}})
    error.errors_rtn_m.push_back({10.0 + 0.6 * along - 0.8 * across, 0.0, 20.0 + 0.8 * along + 0.6 * across});
  const PlaneMiss miss = miss_in(kPlane, error, kConfidence);
  EXPECT_NEAR(miss.mean_m[0], 10.0, 1e-14);
  EXPECT_NEAR(miss.mean_m[1], 20.0, 1e-14);
  EXPECT_NEAR(miss.sigma_m[0], std::sqrt(50.0 / 3.0), 1e-13);
  EXPECT_NEAR(miss.sigma_m[1], std::sqrt(8.0 / 3.0), 1e-13);
  EXPECT_NEAR(miss.angle_rad, std::atan2(0.8, 0.6), 1e-14);
  EXPECT_FALSE(miss.r95_m.upper) << "four cases do not bound it";
  EXPECT_FALSE(miss.cep_m.estimate);
}

TEST(Miss, IsFoundByItsThreeComponents) {
  Campaign campaign;
  campaign.cases.resize(4);
  for (Case& one : campaign.cases) one.state = State::kComplete;
  campaign.cases[1].state = State::kFailed;
  campaign.figures = {{"waypoints.9.control_error_r_m", {1, 2, 3, 4}},
                      {"waypoints.9.control_error_t_m", {1, 2, 3, std::nan("")}},
                      {"waypoints.9.control_error_n_m", {5, 6, 7, 8}},
                      {"samples.1h.sigma_r_m", {1, 1, 1, 1}},
                      {"waypoints.10.control_error_r_m", {1, 2, 3, 4}}};
  const std::vector<VectorError> found = vector_errors(campaign);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].key, "waypoints.9.control_error");
  ASSERT_EQ(found[0].errors_rtn_m.size(), 2U) << "neither failed cases nor those without a component";
  EXPECT_EQ(found[0].errors_rtn_m[1][2], 7.0);
}

class KeptFlights : public report::test::ScratchFolder {
 protected:
  void keep(const std::string& folder, const std::string& truth, const std::string& estimate) const {
    constexpr const char* kHead =
        "time_s,relative_position_rtn_r_m,relative_position_rtn_t_m,relative_position_rtn_n_m\n";
    std::filesystem::create_directories(scratch_ / folder);
    write(scratch_ / folder / "truth.csv", kHead + truth);
    if (!estimate.empty()) write(scratch_ / folder / "estimate.csv", kHead + estimate);
  }
};

TEST_F(KeptFlights, AreThoseOfCompleteCasesWithTables) {
  keep("runs/a", "3600,30,40,0\n7200,0,-12,5\n", "3600,33,40,4\n7200,,,\n7260,1,1,1\n");
  keep("runs/b", "3600,6,0,8\n", "");
  keep("runs/failed", "3600,1,0,0\n", "");
  Campaign campaign;
  for (const char* const folder : {"runs/a", "", "runs/b", "runs/failed", "runs/none"}) {
    Case one;
    one.number = campaign.cases.size();
    one.state = one.number == 3 ? State::kFailed : State::kComplete;
    one.folder = folder;
    campaign.cases.push_back(one);
  }
  const std::vector<Flight> flights = kept_flights(scratch_, campaign);
  ASSERT_EQ(flights.size(), 2U);
  EXPECT_EQ(flights[0].number, 0U);
  ASSERT_EQ(flights[0].range.size(), 2U);
  EXPECT_EQ(flights[0].range[0].x, 1.0);
  EXPECT_NEAR(flights[0].range[0].y, 50.0, 1e-13);
  EXPECT_NEAR(flights[0].range[1].y, 13.0, 1e-14);
  ASSERT_EQ(flights[0].error.size(), 1U) << "neither a row without an estimate nor one of another time";
  EXPECT_NEAR(flights[0].error[0].y, 5.0, 1e-14);
  EXPECT_EQ(flights[1].number, 2U);
  EXPECT_TRUE(flights[1].error.empty());
  EXPECT_NEAR(flights[1].range[0].y, 10.0, 1e-14);
  const std::string html = page_of(campaign, "campaign", {}, flights);
  EXPECT_THAT(html, HasSubstr("<h2>Flights over time</h2>"));
  EXPECT_THAT(html, HasSubstr("median of the cases"));
  EXPECT_THAT(page_of(campaign, "campaign", {}), Not(HasSubstr("Flights over time")));
}

}  // namespace

}  // namespace vbar::campaign_report::test
