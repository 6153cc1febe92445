#include <fstream>
#include <regex>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign_report/distribution_plots.h"
#include "host_sim/campaign_report/write_page.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"
#include "tests/unit/host_sim/report/program_output.h"
#include "tests/unit/host_sim/report/scratch_folder.h"

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
  for (const char* const heading : {"Pass rates", "Distributions", "Miss distances", "Consistency of the filter",
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
}  // namespace vbar::campaign_report::test
