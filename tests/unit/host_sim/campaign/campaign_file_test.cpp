// Campaign files: what they expand to, and what is refused.

#include <bit>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign/plan.h"
#include "host_sim/campaign/value_text.h"
#include "host_sim/mission/mission_error.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/campaign/campaign_text.h"

namespace vbar::campaign {
namespace {

using test::campaign_of;
using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal_of(const std::string& general, const std::string& rest = "") {
  try {
    static_cast<void>(campaign_of(general, rest));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CampaignFile, ExpandsToTheProductOfItsSweepsForEachSeed) {
  const CampaignFile campaign = campaign_of("seeds = [4, 2]", R"(
[[sweep]]
key = "loss"
values = [0.0, 0.2]
[[sweep]]
keys = ["mass", "area"]
rows = [[40.0, 0.38], [80.0, 0.76]]
)");
  const std::vector<Case> cases = expand(campaign);
  ASSERT_EQ(cases.size(), 8U);
  EXPECT_EQ(cases[0].seed, 4U);
  EXPECT_THAT(cases[0].values, ElementsAre("0.0", "40.0", "0.38"));
  EXPECT_THAT(cases[1].values, ElementsAre("0.0", "80.0", "0.76"));
  EXPECT_THAT(cases[2].values, ElementsAre("0.2", "40.0", "0.38"));
  EXPECT_EQ(cases[4].seed, 2U);
  EXPECT_EQ(cases[7].number, 7U);
}

TEST(CampaignFile, SetsThePathsOfTheMission) {
  const CampaignFile campaign = campaign_of("seeds = [4]\nset = [\"truth.moon=true\"]\nsamples_h = [39.5, 40.0]", R"(
[[sweep]]
key = "gnss.start.mode"
values = ["cold"]
)");
  const std::vector<std::string> light = overrides_of(plan_of(campaign), expand(campaign)[0], false);
  EXPECT_THAT(light, ElementsAre("truth.moon=true", "gnss.start.mode=cold", "mission.seed=4",
                                 "record.samples_h=[39.5, 40.0]", "record.packets=false", "record.tables=false"));
}

TEST(CampaignFile, KeepsItsCasesInATable) {
  const CampaignFile campaign = campaign_of("seeds = \"1..2\"", R"(
[[sweep]]
key = "name"
values = ["a, \"quoted\" text", "plain"]
[[sweep]]
key = "fault"
values = [[{ kind = "silent", at_h = 39.1 }]]
)");
  const std::vector<Case> cases = expand(campaign);
  const auto file = std::filesystem::path(testing::TempDir()) / "vbar_cases.csv";
  std::ofstream(file) << cases_text(campaign.keys(), cases);
  const std::vector<Case> read = read_cases(file, campaign.keys());
  std::filesystem::remove(file);
  ASSERT_EQ(read.size(), cases.size());
  for (std::size_t k = 0; k < read.size(); ++k) EXPECT_EQ(read[k].values, cases[k].values);
  EXPECT_EQ(cases[0].values[0], R"("a, \"quoted\" text")");
  EXPECT_EQ(cases[1].values[0], "plain");
}

TEST(CampaignFile, WritesNumbersThatAreReadAsTheSameBits) {
  for (const double value : {0.1, 1.0 / 3.0, 3.0, -0.0, 5e-324, 1.7976931348623157e308, 123456789012345680.0}) {
    const toml::table table = toml::parse("x = " + text_of(value));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(table["x"].as_floating_point()->get()), std::bit_cast<std::uint64_t>(value))
        << text_of(value);
  }
}

TEST(CampaignFile, RefusesWhatItCannotMean) {
  const char* const kSeed = "seeds = \"1..2\"";
  EXPECT_THAT(refusal_of("seeds = \"2..1\""), HasSubstr("FIRST..LAST"));
  EXPECT_THAT(refusal_of("seeds = [1, 1]"), HasSubstr("different integers"));
  EXPECT_THAT(refusal_of(std::string(kSeed) + "\nkeep = \"worst:0\""), HasSubstr("worst:N"));
  EXPECT_THAT(refusal_of(std::string(kSeed) + "\nseads = 3"), HasSubstr("seads"));
  EXPECT_THAT(refusal_of(kSeed, "[[sweep]]\nkey = \"a\"\nvalues = []"), HasSubstr("at least one value"));
  EXPECT_THAT(refusal_of(kSeed, "[[sweep]]\nkey = \"a\"\nvalues = [1, 1]"), HasSubstr("twice"));
  EXPECT_THAT(refusal_of(kSeed, "[[sweep]]\nkeys = [\"a\", \"b\"]\nrows = [[1]]"), HasSubstr("rows of 2 values"));
  EXPECT_THAT(refusal_of(kSeed, "[[sweep]]\nkey = \"mission.seed\"\nvalues = [1]"), HasSubstr("mission.seed"));
  EXPECT_THAT(refusal_of(kSeed,
                         "[[sweep]]\nkey = \"a\"\nvalues = [1]\n[[disperse]]\nkey = \"a\"\ndistribution = "
                         "\"uniform\"\nlow = 0.0\nhigh = 1.0"),
              HasSubstr("varied twice"));
  EXPECT_THAT(refusal_of(kSeed, "[[disperse]]\nkey = \"a\"\ndistribution = \"gauss\""), HasSubstr("log_uniform"));
  EXPECT_THAT(refusal_of(kSeed, "[[disperse]]\nkey = \"a\"\ndistribution = \"uniform\"\nlow = 1.0\nhigh = 1.0"),
              HasSubstr("a number above low"));
  EXPECT_THAT(refusal_of(kSeed,
                         "[[disperse]]\nkeys = [\"a\", \"b\"]\nmean = [0.0, 0.0]\ncovariance = [[1.0, 2.0], "
                         "[2.0, 1.0]]"),
              HasSubstr("positive definite"));
  EXPECT_THAT(refusal_of(kSeed, "[[pass]]\nkey = \"dv_mps\""), HasSubstr("neither most nor least"));
  EXPECT_THAT(refusal_of(kSeed, "[require]\npass_rate_at_least = 1.5"), HasSubstr("pass_rate_at_least"));
}

TEST(CampaignFile, ReadsASweepFromATable) {
  const auto folder = std::filesystem::path(testing::TempDir());
  std::ofstream(folder / "vbar_targets.csv") << "mass,area\n40.0,0.38\n80.0,0.76\n";
  const CampaignFile campaign = parse_campaign(
      "[campaign]\nmission = \"m\"\nseeds = [1]\n[[sweep]]\ntable = \"vbar_targets.csv\"\n", folder / "c.toml");
  std::filesystem::remove(folder / "vbar_targets.csv");
  const std::vector<Case> cases = expand(campaign);
  ASSERT_EQ(cases.size(), 2U);
  EXPECT_THAT(cases[1].values, ElementsAre("80.0", "0.76"));
}

TEST(CampaignFile, OfEveryExampleIsRead) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(tests::source_path("missions/campaigns"))) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_FALSE(expand(read_campaign_file(entry.path())).empty()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 5);
}

}  // namespace
}  // namespace vbar::campaign
