#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign_report/campaign.h"
#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::campaign_report::test {
namespace {

using testing::HasSubstr;

constexpr const char* kColumns =
    "case,seed,mass_kg,state,passed,failed_limits,reason,attempts,host,processor,wall_s,cpu_s,commands_sha256,"
    "telemetry_sha256,waypoints_sha256,folder,dv_mps,samples.1.5h.nees,samples.1.5h.nees_dimension\n";
constexpr const char* kFirst = "0,7,154.5,complete,1,,,1,here,x86,1.5,1.0,a,b,c,,0.5,6.1,6\n";
constexpr const char* kSecond = "1,8,155,complete,0,dv_mps,,2,here,x86,1.5,1.0,a,b,c,runs/000001,2.5,5.9,6\n";
constexpr const char* kThird = "2,9,153,failed,,,\"no \"\"fix\"\", and ended\",1,here,x86,0.5,0.4,,,,,,,\n";

class ReadCampaign : public report::test::ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    write_json(R"("pass": [{"key": "dv_mps", "most": 2.0, "least": null}])");
    write_results(std::string(kFirst) + kSecond + kThird);
  }
  void write_json(const std::string& members, const std::string& others = R"("cases": 3, "independent": true)") const {
    write(
        scratch_ / "campaign.json",
        R"({"format": 1, "name": "n", "description": "d", "mission": "m", "vbar_version": "0.1.0", "program_sha256": "s",
              "keys": ["mass_kg"], "swept": [], "samples_h": [1.5], "require": null, )" +
            others + ", " + members + "}");
  }
  void write_results(const std::string& rows) const { write(scratch_ / "results.csv", kColumns + rows); }

  /// What reading says, which has to name the file.
  [[nodiscard]] std::string complaint() const {
    try {
      static_cast<void>(read_campaign(scratch_));
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      return what.find("campaign.json") != std::string::npos || what.find("results.csv") != std::string::npos
                 ? what
                 : "names no file: " + what;
    }
    return "nothing";
  }
};

TEST_F(ReadCampaign, HoldsWhatTheFilesSay) {
  const Campaign campaign = read_campaign(scratch_);
  ASSERT_EQ(campaign.cases.size(), 3U);
  EXPECT_EQ(campaign.cases[0].seed, "7");
  EXPECT_EQ(campaign.cases[0].inputs.at(0), "154.5");
  EXPECT_TRUE(campaign.cases[0].has_passed());
  EXPECT_FALSE(campaign.cases[1].has_passed());
  EXPECT_EQ(campaign.cases[1].folder, "runs/000001");
  EXPECT_EQ(campaign.cases[2].state, State::kFailed);
  EXPECT_EQ(campaign.cases[2].reason, "no \"fix\", and ended");
  ASSERT_EQ(campaign.figures.size(), 3U);
  EXPECT_EQ(campaign.figure("dv_mps")->values.at(1), 2.5);
  EXPECT_TRUE(std::isnan(campaign.figure("dv_mps")->values.at(2)));
  EXPECT_EQ(campaign.limits.at(0).max, 2.0);
  EXPECT_FALSE(campaign.limits.at(0).min);
}

TEST_F(ReadCampaign, OrderOfTheRowsDoesNotMatter) {
  write_results(std::string(kThird) + kFirst + kSecond);
  const Campaign campaign = read_campaign(scratch_);
  EXPECT_EQ(campaign.cases[0].number, 0U);
  EXPECT_EQ(campaign.cases[2].state, State::kFailed);
  EXPECT_EQ(campaign.figure("dv_mps")->values.at(1), 2.5);
}

TEST_F(ReadCampaign, RefusesMissingFilesColumnsAndCases) {
  std::filesystem::remove(scratch_ / "results.csv");
  EXPECT_THAT(complaint(), HasSubstr("results.csv: no such file"));
  write(scratch_ / "results.csv", "");
  EXPECT_THAT(complaint(), HasSubstr("is empty"));
  write(scratch_ / "results.csv", "case,seed,mass_kg\n0,1,2\n");
  EXPECT_THAT(complaint(), HasSubstr("no column \"state\""));
  write_results(std::string(kFirst) + kSecond);
  EXPECT_THAT(complaint(), HasSubstr("2 cases, although campaign.json says 3"));
  write_results(std::string(kFirst) + kSecond + kFirst);
  EXPECT_THAT(complaint(), HasSubstr("case 0 occurs twice"));
  write_results(std::string(kFirst) + kSecond + "2,9,153\n");
  EXPECT_THAT(complaint(), HasSubstr("results.csv:4: 3 cells, although there are 19 columns"));
}

TEST_F(ReadCampaign, RefusesNumbersThatAreNotFinite) {
  for (const char* const bad : {"nan", "inf", "-inf", "1e999", "0x1", "two", " 1"}) {
    write_results(std::string(kFirst) + kSecond + "2,9,153,failed,,,r,1,here,x86,0.5," + bad + ",,,,,,,\n");
    EXPECT_THAT(complaint(), HasSubstr("results.csv:4: column \"cpu_s\": \"" + std::string(bad) + "\" is not")) << bad;
    write_results(std::string(kFirst) + kSecond + "2,9,153,failed,,,r,1,here,x86,0.5,0.4,,,,," + bad + ",,\n");
    EXPECT_THAT(complaint(), HasSubstr("results.csv:4: column \"dv_mps\"")) << bad;
  }
}

TEST_F(ReadCampaign, RefusesResultsThatContradictThemselves) {
  const auto complaint_of = [&](const char* row) {
    write_results(std::string(kFirst) + kSecond + row);
    return complaint();
  };
  EXPECT_THAT(complaint_of("2,9,153,gone,,,r,1,here,x86,1,1,,,,,,,\n"),
              HasSubstr("accepted: not_begun, flying, complete"));
  EXPECT_THAT(complaint_of("2,9,153,failed,1,,r,1,here,x86,1,1,,,,,,,\n"), HasSubstr("column \"passed\""));
  EXPECT_THAT(complaint_of("2,9,153,complete,,,,1,here,x86,1,1,,,,,1.0,6,6\n"), HasSubstr("column \"passed\""));
  EXPECT_THAT(complaint_of("2,9,153,complete,1,,,1,here,x86,1,1,,,,,3.0,6,6\n"),
              HasSubstr("case 2 is marked as passed, although \"dv_mps\" is 3 (at most 2"));
  EXPECT_THAT(complaint_of("2,9,153,complete,1,,,1,here,x86,1,1,,,,,,6,6\n"), HasSubstr("\"dv_mps\" is missing"));
  EXPECT_THAT(complaint_of("2,9,153,complete,0,,,1,here,x86,1,1,,,,,1.0,6,6\n"), HasSubstr("within all limits"));
  EXPECT_THAT(complaint_of("2,9,153,failed,,,\"r,1,here,x86,1,1,,,,,,,\n"), HasSubstr("results.csv:4: a quote"));
}

TEST_F(ReadCampaign, RefusesMembersThatAreMissingOrOfAnotherKind) {
  const auto complaint_of = [&](const std::string& members,
                                const std::string& others = R"("cases": 3, "independent": true)") {
    write_json(members, others);
    return complaint();
  };
  EXPECT_THAT(complaint_of(R"("other": 1)"), HasSubstr("campaign.json: key \"pass\": is missing"));
  EXPECT_THAT(complaint_of(R"("pass": [{"key": "dv_mps"}])"), HasSubstr("pass[0]: key \"most\""));
  EXPECT_THAT(complaint_of(R"("pass": [{"key": "dv_mps", "most": "2"}])"), HasSubstr("\"2\" is not a number"));
  EXPECT_THAT(complaint_of(R"("pass": [{"key": "dv", "most": 2}])"), HasSubstr("results.csv: no column \"dv\""));
  EXPECT_THAT(complaint_of(R"("pass": [])", R"("cases": 3)"), HasSubstr("key \"independent\": is missing"));
  EXPECT_THAT(complaint_of(R"("pass": [], "swept": ["x"])", R"("cases": 3, "independent": true)"),
              HasSubstr("\"x\" is not in \"keys\""));
  EXPECT_THAT(complaint_of(R"("pass": [], "require": {"pass_rate_at_least": 95, "confidence": 0.95})"),
              HasSubstr("require: key \"pass_rate_at_least\": 95 is not between 0 and 1"));
  EXPECT_THAT(complaint_of(R"("pass": [], "format": 2)"), HasSubstr("2 is not supported; accepted: 1"));
  write(scratch_ / "campaign.json", "{");
  EXPECT_THAT(complaint(), HasSubstr("campaign.json:1: the file is cut off here"));
  write(scratch_ / "campaign.json", "[]");
  EXPECT_THAT(complaint(), HasSubstr("a JSON object is expected"));
}

}  // namespace
}  // namespace vbar::campaign_report::test
