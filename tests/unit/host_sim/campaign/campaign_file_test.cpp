// Campaign files: what they expand to, and what is refused.

#include "host_sim/campaign/campaign_file.h"

#include <algorithm>
#include <bit>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <locale>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign/case.h"
#include "host_sim/campaign/plan.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/mission/mission_error.h"
#include "tests/support/paths.h"

namespace vbar::campaign {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CampaignFile campaign_of(const std::string& general, const std::string& rest = "") {
  return parse_campaign("[campaign]\nmission = \"experiment3\"\n" + general + "\n" + rest, "test.toml");
}

/// Value of `key` in the case of that seed whose swept values are `swept`.
std::string value_of(const CampaignFile& campaign, std::uint64_t seed, const std::vector<std::string>& swept,
                     const std::string& key) {
  const std::vector<std::string> keys = campaign.keys();
  for (const Case& one : expand(campaign)) {
    if (one.seed != seed || !std::equal(swept.begin(), swept.end(), one.values.begin())) continue;
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (keys[k] == key) return one.values[k];
  }
  return "no such case";
}

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

constexpr const char* kStated = "seeds = \"1..2\"";

TEST(Requirements, AreReadWithTheirStatistics) {
  using campaign_report::Statistic;
  const CampaignFile campaign = campaign_of(kStated, R"(
[[require]]
key = "waypoints.10.navigation_error_m"
statistic = "percentile"
percentile = 95.0
most = 0.045
confidence = 0.9
allow_missing = 2
paper = "table_4.waypoint_10.navigation"
[[require]]
statistic = "share"
verdict = ["achieved", "achieved with faults"]
least = 0.9
[[require]]
key = "dv_mps"
statistic = "worst"
least = -1
[[require]]
pass_rate_at_least = 0.8
)");
  const std::vector<Requirement>& all = campaign.requirements;
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].statistic, Statistic::kPercentile);
  EXPECT_EQ(all[0].key, "waypoints.10.navigation_error_m");
  EXPECT_EQ(all[0].percentile, 95.0);
  EXPECT_EQ(all[0].most, 0.045);
  EXPECT_FALSE(all[0].least);
  EXPECT_EQ(all[0].confidence, 0.9);
  EXPECT_EQ(all[0].allow_missing, 2U);
  EXPECT_EQ(all[0].paper, "table_4.waypoint_10.navigation");
  EXPECT_EQ(all[1].statistic, Statistic::kShare);
  EXPECT_THAT(all[1].verdicts, ElementsAre("achieved", "achieved with faults"));
  EXPECT_EQ(all[1].confidence, 0.95) << "a share is judged by its bound";
  EXPECT_EQ(all[2].least, -1.0);
  EXPECT_FALSE(all[2].confidence);
  EXPECT_EQ(all[3].statistic, Statistic::kPassRate);
  EXPECT_EQ(all[3].least, 0.8);
  const CampaignFile single = campaign_of(kStated, "[require]\npass_rate_at_least = 0.8\nconfidence = 0.9");
  ASSERT_EQ(single.requirements.size(), 1U);
  EXPECT_EQ(single.requirements[0].confidence, 0.9);
}

TEST(Requirements, ThatCannotBeMeantAreRefused) {
  const auto refused = [](const std::string& lines) { return refusal_of(kStated, "[[require]]\n" + lines); };
  EXPECT_THAT(refused("key = \"a\"\nmost = 1"), HasSubstr("test.toml:4: require.0.statistic: found nothing"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"modus\"\nmost = 1"),
              HasSubstr("test.toml:6: require.0.statistic: found the text \"modus\"; accepted: median, mean, worst, "
                        "percentile or share"));
  EXPECT_THAT(refused("statistic = \"median\"\nmost = 1"), HasSubstr("require.0.key: found nothing"));
  EXPECT_THAT(refused("key = \"\"\nstatistic = \"median\"\nmost = 1"), HasSubstr("a number of summary.json"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"median\""), HasSubstr("neither most nor least"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"median\"\nmost = 1\nleast = 0"), HasSubstr("both most and least"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"median\"\nmost = nan"), HasSubstr("require.0.most: found nan"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"median\"\nmost = 1\nconfidence = 0.9"),
              HasSubstr("test.toml:8: require.0.confidence: found this key with statistic = \"median\"; accepted: "
                        "confidence with statistic = \"percentile\" or \"share\" only"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"mean\"\npercentile = 50\nmost = 1"),
              HasSubstr("percentile with statistic = \"percentile\" only"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"percentile\"\nmost = 1"), HasSubstr("require.0.percentile"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"percentile\"\npercentile = 100\nmost = 1"),
              HasSubstr("above 0, up to 99.9999"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"share\"\nverdict = \"achieved\"\nleast = 1"),
              HasSubstr("key with statistic ="));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"worst\"\nverdict = \"achieved\"\nleast = 1"),
              HasSubstr("verdict with statistic = \"share\" only"));
  EXPECT_THAT(refused("statistic = \"share\"\nverdict = \"good\"\nleast = 1"),
              HasSubstr("found the text \"good\"; accepted: achieved, achieved with faults, not judged, missed"));
  EXPECT_THAT(refused("statistic = \"share\"\nverdict = []\nleast = 1"), HasSubstr("require.0.verdict"));
  EXPECT_THAT(refused("statistic = \"share\"\nverdict = \"achieved\"\nleast = 95"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(refused("statistic = \"share\"\nverdict = \"achieved\"\nleast = 0.9\nallow_missing = -1"),
              HasSubstr("require.0.allow_missing"));
  EXPECT_THAT(refused("key = \"a\"\nstatistic = \"median\"\nmost = 1\nat_most = 2"), HasSubstr("at_most"));
  EXPECT_THAT(refused("pass_rate_at_least = 0.9\nmost = 1"), HasSubstr("most"));
}

constexpr const char* kDrawn = "name = \"night\"\nseeds = { count = 100, from = \"commit\" }";
constexpr const char* kCommit = "4c048e93e2a1";

std::vector<std::uint64_t> seeds_of(const std::string& general, const std::string& commit,
                                    const std::string& seeds_from = "") {
  CampaignFile campaign = campaign_of(general);
  draw_seeds(campaign, commit, seeds_from);
  return campaign.seeds;
}

TEST(SeedsFromTheCommit, AreDistinctAndAFunctionOfCommitAndName) {
  const std::vector<std::uint64_t> seeds = seeds_of(kDrawn, kCommit);
  ASSERT_EQ(seeds.size(), 100U);
  EXPECT_EQ(std::set(seeds.begin(), seeds.end()).size(), 100U);
  // printf '4c048e93e2a1\nnight\n0' | sha256sum | cut -c 1-8, and with 1 in place of 0
  EXPECT_EQ(seeds[0], 1326054929U);
  EXPECT_EQ(seeds[1], 3769911069U);
  EXPECT_EQ(seeds_of(kDrawn, kCommit), seeds);
  EXPECT_EQ(seeds_of(kDrawn, "unknown", "4C048E93E2A1bd7e3cb4000000000000000000000"), seeds) << "the whole hash";
  EXPECT_NE(seeds_of(kDrawn, "4c048e93e2a1+")[0], seeds[0]) << "files were changed";
  EXPECT_NE(seeds_of(kDrawn, "5c048e93e2a1")[0], seeds[0]);
  EXPECT_NE(seeds_of("name = \"day\"\nseeds = { count = 100, from = \"commit\" }", kCommit)[0], seeds[0]);
  const std::vector<std::uint64_t> more =
      seeds_of("name = \"night\"\nseeds = { count = 150, from = \"commit\" }", kCommit);
  EXPECT_TRUE(std::equal(seeds.begin(), seeds.end(), more.begin())) << "a larger count moves no seed";
}

TEST(SeedsFromTheCommit, StandInThePlanWithIt) {
  CampaignFile campaign = campaign_of(kDrawn);
  draw_seeds(campaign, "4c048e93e2a1+", "");
  EXPECT_EQ(plan_of(campaign).seeds_from, "4c048e93e2a1+");
  EXPECT_EQ(expand(campaign)[3].seed, campaign.seeds[3]);
}

TEST(SeedsFromTheCommit, NeedOne) {
  const auto refused = [](const std::string& general, const std::string& commit, const std::string& seeds_from) {
    try {
      static_cast<void>(seeds_of(general, commit, seeds_from));
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused(kDrawn, "unknown", ""),
            "test.toml:4: campaign.seeds.from: found \"commit\" in a program whose commit is unknown; accepted: a "
            "program built in a git work tree, or --seeds-from HEX");
  EXPECT_THAT(refused(kDrawn, kCommit, "night"), HasSubstr("--seeds-from: found night; accepted: 7 to 64 hexadecimal"));
  EXPECT_THAT(refused(kDrawn, kCommit, "4c048e"), HasSubstr("--seeds-from"));
  EXPECT_THAT(refused(kStated, kCommit, kCommit), HasSubstr("although test.toml states its seeds"));
  EXPECT_EQ(refused(kStated, "unknown", ""), "accepted");
  EXPECT_THAT(refusal_of("seeds = { count = 0, from = \"commit\" }"), HasSubstr("campaign.seeds.count"));
  EXPECT_THAT(refusal_of("seeds = { count = 1000001, from = \"commit\" }"), HasSubstr("from 1 to 1000000"));
  EXPECT_THAT(refusal_of("seeds = { count = 5 }"), HasSubstr("campaign.seeds.from"));
  EXPECT_THAT(refusal_of("seeds = { count = 5, from = \"dice\" }"), HasSubstr("accepted: commit"));
  EXPECT_THAT(refusal_of("seeds = { count = 5, from = \"commit\", first = 2 }"), HasSubstr("first"));
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

// The numbers of a case are a function of the campaign's seed, the key and the case's seed, whatever else the file
// holds.

namespace {

constexpr const char* kMass = R"(
[[disperse]]
key = "mass"
distribution = "uniform"
low = 0.0
high = 1.0
)";
constexpr const char* kArea = R"(
[[disperse]]
key = "area"
distribution = "normal"
mean = 3.0
sigma = 0.5
)";
constexpr const char* kLoss = R"(
[[sweep]]
key = "loss"
values = [0.0, 0.05]
)";

TEST(Draws, ComeFromTheStreamNamedByTheKeyAtTheSeedOfTheCase) {
  const CampaignFile campaign = campaign_of("seeds = \"5..9\"\nseed = 7", kMass);
  for (const std::uint64_t seed : {5U, 9U}) {
    const double expected = engine::RandomStream(7, "mass").uniforms_of(seed)[0];
    EXPECT_EQ(value_of(campaign, seed, {}, "mass"), text_of(expected));
  }
}

TEST(Draws, DoNotDependOnOtherKeysSeedsOrSweepValues) {
  const CampaignFile alone = campaign_of("seeds = \"1..5\"", std::string(kLoss) + kMass);
  const CampaignFile more_keys = campaign_of("seeds = \"1..5\"", std::string(kArea) + kLoss + kMass);
  const CampaignFile more_seeds = campaign_of("seeds = [40, 5, 3, 9, 1]", std::string(kLoss) + kMass);
  const CampaignFile more_values =
      campaign_of("seeds = \"1..5\"", std::string("[[sweep]]\nkey = \"loss\"\nvalues = [0.3, 0.0, 0.05]\n") + kMass);
  for (const std::uint64_t seed : {1U, 3U, 5U}) {
    const std::string expected = value_of(alone, seed, {"0.05"}, "mass");
    for (const CampaignFile* other : {&more_keys, &more_seeds, &more_values})
      EXPECT_EQ(value_of(*other, seed, {"0.05"}, "mass"), expected);
  }
  EXPECT_NE(value_of(alone, 1, {"0.05"}, "mass"), value_of(alone, 3, {"0.05"}, "mass"));
}

TEST(Draws, OfSweepPointsAreCommonUnlessTheFileSaysOtherwise) {
  const CampaignFile common = campaign_of("seeds = \"1..5\"", std::string(kLoss) + kMass);
  EXPECT_EQ(value_of(common, 2, {"0.0"}, "mass"), value_of(common, 2, {"0.05"}, "mass"));
  const CampaignFile own = campaign_of("seeds = \"1..5\"\ncommon_draws = false", std::string(kLoss) + kMass);
  EXPECT_NE(value_of(own, 2, {"0.0"}, "mass"), value_of(own, 2, {"0.05"}, "mass"));
  const CampaignFile more = campaign_of("seeds = \"1..6\"\ncommon_draws = false",
                                        std::string("[[sweep]]\nkey = \"loss\"\nvalues = [0.3, 0.05]\n") + kMass);
  EXPECT_EQ(value_of(own, 2, {"0.05"}, "mass"), value_of(more, 2, {"0.05"}, "mass"));
}

TEST(Draws, OfALatinHypercubeLieInOneStratumEach) {
  const CampaignFile campaign = campaign_of("seeds = \"1..50\"\nsampling = \"latin\"", kMass);
  std::set<int> strata;
  for (const Case& one : expand(campaign)) strata.insert(static_cast<int>(std::floor(50.0 * std::stod(one.values[0]))));
  EXPECT_EQ(strata.size(), 50U);
}

TEST(Draws, AreWrittenInTheSameWayInEveryLocale) {
  const std::string before = cases_text({"mass"}, expand(campaign_of("seeds = \"1..3\"", kMass)));
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale old = std::locale::global(std::locale(std::locale::classic(), new Comma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string now = cases_text({"mass"}, expand(campaign_of("seeds = \"1..3\"", kMass)));
  std::locale::global(old);
  std::setlocale(LC_ALL, "C");
  EXPECT_EQ(now, before);
}

TEST(Draws, HaveTheMeanAndDeviationOfTheirDistribution) {
  constexpr const char* kFile = R"(
[[disperse]]
key = "normal"
distribution = "normal"
mean = 3.0
sigma = 0.5
[[disperse]]
key = "cut"
distribution = "normal"
mean = 0.0
sigma = 1.0
low = -1.0
high = 1.0
[[disperse]]
key = "log"
distribution = "log_uniform"
low = 1.0
high = 100.0
[[disperse]]
key = "integer"
distribution = "integer"
low = 1
high = 6
)";
  std::vector<std::vector<double>> columns(4);
  for (const Case& one : expand(campaign_of("seeds = \"1..20000\"", kFile)))
    for (std::size_t k = 0; k < 4; ++k) columns[k].push_back(std::stod(one.values[k]));
  const auto moments = [](const std::vector<double>& values) {
    double sum = 0.0, squares = 0.0;
    for (const double v : values) sum += v;
    const double mean = sum / static_cast<double>(values.size());
    for (const double v : values) squares += (v - mean) * (v - mean);
    return std::pair(mean, std::sqrt(squares / static_cast<double>(values.size())));
  };
  // Five standard deviations of the estimates from 20,000 draws.
  const auto [normal_mean, normal_sigma] = moments(columns[0]);
  EXPECT_NEAR(normal_mean, 3.0, 0.018);
  EXPECT_NEAR(normal_sigma, 0.5, 0.013);
  const auto [cut_mean, cut_sigma] = moments(columns[1]);
  EXPECT_NEAR(cut_mean, 0.0, 0.02);
  EXPECT_NEAR(cut_sigma, 0.53956, 0.02);  // of a standard normal cut off at one sigma
  EXPECT_TRUE(std::ranges::all_of(columns[1], [](double v) { return v >= -1.0 && v <= 1.0; }));
  EXPECT_NEAR(moments(columns[2]).first, 99.0 / std::log(100.0), 1.0);
  EXPECT_NEAR(moments(columns[3]).first, 3.5, 0.06);
  EXPECT_EQ(std::set<double>(columns[3].begin(), columns[3].end()), (std::set<double>{1, 2, 3, 4, 5, 6}));
}

TEST(Draws, OfCorrelatedKeysHaveTheCovarianceOfTheFile) {
  constexpr const char* kFile = R"(
[[disperse]]
keys = ["a", "b"]
mean = [1.0, -2.0]
covariance = [[4.0, 3.0], [3.0, 9.0]]
)";
  double aa = 0.0, ab = 0.0, bb = 0.0, count = 0.0;
  for (const Case& one : expand(campaign_of("seeds = \"1..20000\"", kFile))) {
    const double a = std::stod(one.values[0]) - 1.0, b = std::stod(one.values[1]) + 2.0;
    aa += a * a, ab += a * b, bb += b * b, count += 1.0;
  }
  EXPECT_NEAR(aa / count, 4.0, 0.2);
  EXPECT_NEAR(ab / count, 3.0, 0.25);
  EXPECT_NEAR(bb / count, 9.0, 0.45);
}

TEST(Draws, OfADirectionHaveItsLengthAndNoPreferredAxis) {
  constexpr const char* kFile = R"(
[[disperse]]
key = "axis"
distribution = "direction"
length = 2.0
)";
  double sum[3] = {}, squares[3] = {}, count = 0.0;
  for (const Case& one : expand(campaign_of("seeds = \"1..20000\"", kFile))) {
    double v[3] = {};
    ASSERT_EQ(std::sscanf(one.values[0].c_str(), "[%lf, %lf, %lf]", &v[0], &v[1], &v[2]), 3);
    ASSERT_NEAR(std::hypot(std::hypot(v[0], v[1]), v[2]), 2.0, 1e-12);
    for (int k = 0; k < 3; ++k) sum[k] += v[k], squares[k] += v[k] * v[k];
    count += 1.0;
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum[k] / count, 0.0, 0.045);
    EXPECT_NEAR(squares[k] / count, 4.0 / 3.0, 0.05);
  }
}

TEST(Draws, OfAChoiceFollowTheWeights) {
  constexpr const char* kFile = R"(
[[disperse]]
key = "mode"
distribution = "choice"
values = ["warm", "hot", "cold"]
weights = [3.0, 1.0, 0.0]
)";
  double warm = 0.0, all = 0.0;
  for (const Case& one : expand(campaign_of("seeds = \"1..20000\"", kFile))) {
    ASSERT_TRUE(one.values[0] == "warm" || one.values[0] == "hot") << one.values[0];
    warm += one.values[0] == "warm" ? 1.0 : 0.0;
    all += 1.0;
  }
  EXPECT_NEAR(warm / all, 0.75, 0.016);
}

}  // namespace

}  // namespace vbar::campaign
