#include "host_sim/report/comparison.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

using testing::ElementsAre;

std::vector<std::string> cells_of(const std::vector<ComparisonRow>& rows, std::string_view name) {
  const auto row =
      std::ranges::find_if(rows, [&](const ComparisonRow& r) { return r.name.find(name) != std::string::npos; });
  return row == rows.end() ? std::vector<std::string>{"no such row"} : row->cells;
}

/// The same mission on two computers, the second run stopped before its last waypoint with another command in it.
std::vector<ComparedRun> two_runs() {
  std::vector<ComparedRun> runs{{"sil", synthetic_run()}, {"pil", synthetic_run()}};
  RunRecord& other = runs[1].record;
  other.waypoints.pop_back();
  other.waypoints[3].control_error_m += 0.125;
  other.summary.complete = false;
  other.summary.incomplete_reason = "interrupted";
  other.summary.commands_sha256 = std::string(64, 'c');
  return runs;
}

TEST(Comparison, SameOutputsNeedsBothHashes) {
  const Summary a = synthetic_run().summary;
  Summary b = a;
  EXPECT_TRUE(same_outputs(a, b));
  b.telemetry_sha256.back() = 'x';
  EXPECT_FALSE(same_outputs(a, b));
  EXPECT_FALSE(same_outputs({}, {})) << "two runs that never spoke are not known to agree";
}

TEST(Comparison, HoldsEachRunAgainstTheFirst) {
  const std::vector<ComparisonRow> rows = comparison_rows(two_runs());
  EXPECT_THAT(cells_of(rows, "outcome"), ElementsAre("complete", "incomplete: interrupted"));
  EXPECT_THAT(cells_of(rows, "largest difference of control error"), ElementsAre("0", "0.125"));
  EXPECT_THAT(cells_of(rows, "maneuver commands"), ElementsAre("same bits", "DIFFERENT"));
  EXPECT_THAT(cells_of(rows, "telemetry"), ElementsAre("same bits", "same bits"));
  EXPECT_THAT(cells_of(rows, "waypoint 3"), ElementsAre("0.3000", "0.4250"));
  EXPECT_THAT(cells_of(rows, "waypoint 10"), ElementsAre("1.0000", "–")) << "never reached";
}

TEST(Comparison, OtherMissionsAndSeedsAreExpectedToDiffer) {
  std::vector<ComparedRun> runs = two_runs();
  EXPECT_TRUE(expect_same_outputs(runs[0].record.summary, runs[1].record.summary));
  runs[1].record.summary.seed = 2;
  EXPECT_FALSE(expect_same_outputs(runs[0].record.summary, runs[1].record.summary));
  EXPECT_THAT(cells_of(comparison_rows(runs), "maneuver commands"),
              ElementsAre("same bits", "other mission, seed or settings"));
  EXPECT_EQ(cells_of(comparison_rows(runs), "waypoint 0"), std::vector<std::string>{"no such row"}) << "the start";
}

TEST(Comparison, OverridesOfTheFlightComputerAloneMustNotChangeOutputs) {
  Summary a, b;
  b.provenance.overrides = {"flight_computer.target=zynq_qemu"};
  EXPECT_TRUE(expect_same_outputs(a, b));
  b.provenance.overrides.emplace_back("truth.drag=true");
  EXPECT_FALSE(expect_same_outputs(a, b));
  a.provenance.overrides = {"truth.drag=true"};
  EXPECT_TRUE(expect_same_outputs(a, b));
}

TEST(Comparison, RunsInFoldersOfTheSameNameAreToldApart) {
  EXPECT_THAT(run_names({"/a/one/run", "/a/two/run/", "/b/one/run", "/a/other"}),
              ElementsAre("a/one/run", "two/run", "b/one/run", "other"));
  EXPECT_THAT(run_names({"/a/run", "/a/run"}), ElementsAre("a/run", "a/run")) << "the same folder twice";
}

TEST(Comparison, OneRunIsHeldAgainstNothing) {
  const std::vector<ComparedRun> one{{"sil", synthetic_run()}};
  for (const ComparisonRow& row : comparison_rows(one)) EXPECT_EQ(row.name.find("against"), std::string::npos);
  EXPECT_TRUE(comparison_rows({}).empty());
}

// Columns stand below each other although "–" and "±" are more than a byte.
TEST(Comparison, ConsoleColumnsAreAligned) {
  const std::string text = comparison_table(two_runs());
  std::size_t longest = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = text.find('\n', start);
    const auto width = static_cast<std::size_t>(std::count_if(text.begin() + static_cast<std::ptrdiff_t>(start),
                                                              text.begin() + static_cast<std::ptrdiff_t>(end),
                                                              [](char c) { return (c & 0xC0) != 0x80; }));
    const bool is_heading = text[start] != ' ' && text.substr(start, end - start).find("  ") == std::string::npos;
    if (!is_heading) {
      if (longest == 0) longest = width;
      EXPECT_EQ(width, longest) << text.substr(start, end - start);
    }
    start = end + 1;
  }
}

}  // namespace
}  // namespace vbar::report::test
