#include "host_sim/report/sections/comparison.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summarise.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_rows.h"
#include "tests/support/paths.h"
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
  EXPECT_THAT(cells_of(rows, "outcome"), ElementsAre("complete", "INCOMPLETE: interrupted"));
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

TEST(Comparison, ColumnsSayWhatWasInTheLoop) {
  std::vector<ComparedRun> runs = two_runs();
  runs[0].record.summary.flight_computer = "in_process";
  runs[1].record.summary.flight_computer = "zynq_qemu";
  EXPECT_THAT(cells_of(comparison_rows(runs), "in the loop"), ElementsAre("SIL, in process", "PIL, emulated Zynq"));
}

TEST(LoopName, IsMadeOfSourcesAndFlightComputer) {
  Summary summary;
  summary.gnss = "digital";
  summary.flight_computer = "host_process";
  EXPECT_EQ(loop_name(summary), "SIL, process of its own");
  summary.flight_computer = "board";
  summary.gnss = "recorded";
  EXPECT_EQ(loop_name(summary), "PIL, board");
  summary.gnss = "grand";
  // A testbed that does not say what it is counts as neither.
  EXPECT_EQ(loop_name(summary), "HIL, testbed grand, board");
  EXPECT_TRUE(emulated_testbeds(summary).empty());
  summary.flight_computer = "in_process";
  EXPECT_EQ(loop_name(summary), "HIL, testbed grand");
  summary.testbeds["grand"]["bench"] = std::string("hardware");
  EXPECT_EQ(loop_name(summary), "HIL, hardware bench");
  EXPECT_TRUE(emulated_testbeds(summary).empty());
  summary.testbeds["grand"]["bench"] = std::string("emulated");
  EXPECT_EQ(loop_name(summary), "HIL, emulated bench");
  EXPECT_THAT(emulated_testbeds(summary), ElementsAre("grand"));
}

// The paper's table "Performance metrics for Experiment #1", waypoints 1 and 7, and its text on delta-v.
TEST(Comparison, Experiment1StandsBesideBothLoopsOfThePaper) {
  std::vector<ComparedRun> runs{{"sil", synthetic_run()}, {"hil", synthetic_run()}};
  for (ComparedRun& run : runs) {
    run.record.summary.navigation = "angles_only";
    run.record.summary.first_fix_s.reset();
  }
  runs[1].record.summary.camera = "optical_stimulator";
  runs[1].record.summary.testbeds["optical_stimulator"]["bench"] = std::string("emulated");
  ASSERT_THAT(column_names(runs),
              ElementsAre("sil", "hil", "paper, software in the loop", "paper, hardware in the loop"));
  const std::vector<ComparisonRow> rows = comparison_rows(runs);
  EXPECT_THAT(cells_of(rows, "in the loop").at(1), testing::HasSubstr("emulated bench"));
  const auto navigation = std::ranges::find(rows, "navigation error, m", &ComparisonRow::name);
  ASSERT_NE(navigation, rows.end());
  EXPECT_EQ((navigation + 1)->cells.at(2), "80.0400");
  EXPECT_EQ((navigation + 1)->cells.at(3), "75.2700");
  const auto control = std::ranges::find(rows, "control error, m", &ComparisonRow::name);
  EXPECT_EQ((control + 7)->cells.at(2), "8.7700");
  EXPECT_EQ((control + 7)->cells.at(3), "4.4700");
  const auto total = std::ranges::find(rows, "  delta-v, m/s", &ComparisonRow::name);
  ASSERT_NE(total, rows.end());
  EXPECT_EQ(total->cells.at(2), "4.69");
  EXPECT_EQ(total->cells.at(3), "4.75");
  EXPECT_EQ(cells_of(rows, "  maneuvers").at(3), "90");
}

TEST(Comparison, NavigationByImagesHasRowsOfItsOwn) {
  std::vector<ComparedRun> runs{{"sil", synthetic_run()}, {"other", synthetic_run()}};
  Summary& s = runs[0].record.summary;
  s.sensor_figures["images"] = {{"images", 200}, {"with_bearing", 162}, {"with_stars", 199}};
  s.bearing_error_arcsec = BearingError{3.0, 2.31, 1.24};
  s.star_attitude_error_arcsec = MeanAndDeviation{0.41, 0.2};
  s.navigation_nees = 6.44;
  Summary& other = runs[1].record.summary;
  other.sensor_figures.clear();
  other.bearing_error_arcsec.reset();
  other.star_attitude_error_arcsec.reset();
  other.navigation_nees.reset();
  const std::vector<ComparisonRow> rows = comparison_rows(runs);
  const auto first_two = [&](const char* name) {
    std::vector<std::string> cells = cells_of(rows, name);
    cells.resize(2);
    return cells;
  };
  EXPECT_THAT(first_two("images with a bearing"), ElementsAre("81.0 % of 200", "–"));
  EXPECT_THAT(first_two("images with stars identified"), ElementsAre("99.5 % of 200", "–"));
  EXPECT_THAT(first_two("bias of the bearings"), ElementsAre("1.24", "–"));
  EXPECT_THAT(first_two("noise of the bearings"), ElementsAre("2.31", "–"));
  EXPECT_THAT(first_two("boresight error of the star attitude"), ElementsAre("0.41 ± 0.20", "–"));
  EXPECT_THAT(first_two("mean NEES"), ElementsAre("6.44", "–"));
  runs[0].record.summary = runs[1].record.summary;
  EXPECT_EQ(cells_of(comparison_rows(runs), "bias of the bearings"), std::vector<std::string>{"no such row"});
}

/// The paper's figures, and a run with carrier phases.
std::vector<PaperColumn> one_paper(const RunRecord& record) {
  if (record.waypoints.empty()) return {};
  PaperColumn paper;
  paper.name = "paper";
  paper.at = [](const WaypointRow& row) -> PaperColumn::AtWaypoint {
    return row.index == 3 ? PaperColumn::AtWaypoint{0.364, 5.05e-3, 0.031e-3} : PaperColumn::AtWaypoint{};
  };
  paper.navigation_error_m = MeanAndDeviation{8.367e-3, 2.679e-3};
  paper.dv_mps = 15.596e-3;
  paper.maneuvers = 11;
  paper.attitude_error_deg = MeanAndDeviation{4.1302, 2.1608};
  return {paper};
}

TEST(Comparison, ThePaperHasColumnsBesideTheRuns) {
  const Extension extension{.paper_columns = one_paper};
  const Extension* const extensions[] = {&extension};
  std::vector<ComparedRun> runs = two_runs();
  for (ComparedRun& run : runs) {
    run.record.extensions = extensions;
    run.record.summary.first_fix_s = 80.0;  // carrier phases: millimetres
    run.record.summary.sensor_figures["gnss"]["time_to_20_mm_s"] = 80.0;
  }
  runs[0].record.summary.attitude_error_deg = MeanAndDeviation{1.39, 0.5};
  runs[1].record.summary.attitude_error_deg.reset();
  runs[1].record.summary.sensor_figures.clear();
  EXPECT_THAT(column_names(runs), ElementsAre("sil", "pil", "paper"));
  const std::vector<ComparisonRow> rows = comparison_rows(runs);
  EXPECT_THAT(cells_of(rows, "waypoint 3"), ElementsAre("0.3000", "0.4250", "0.3640")) << "control error";
  EXPECT_THAT(cells_of(rows, "waypoint 10"), ElementsAre("1.0000", "–", "–"));
  EXPECT_EQ(cells_of(rows, "navigation error, mm (mean").at(2), "8.367 ± 2.679");
  EXPECT_EQ(cells_of(rows, "  delta-v, mm/s").at(2), "15.596");
  EXPECT_EQ(cells_of(rows, "  maneuvers").at(2), "11");
  EXPECT_THAT(cells_of(rows, "attitude error"), ElementsAre("1.39 ± 0.50", "–", "4.13 ± 2.16"));
  EXPECT_THAT(cells_of(rows, "time_to_20_mm_s"), ElementsAre("80", "–", "–"));
  EXPECT_EQ(cells_of(rows, "telemetry").at(2), "–") << "the paper has no bits to compare";
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

// Run folders of an earlier version (tests/data/earlier_runs/README.md). Expected values are read off its files.

namespace {

constexpr double kArcsecond = M_PI / 648000.0;

RunRecord earlier_run(const std::string& name) {
  return read_run(vbar::tests::source_path("tests/data/earlier_runs/" + name), sensors::extensions());
}

TEST(EarlierRuns, ImagesAreConverted) {
  const RunRecord record = earlier_run("experiment1");
  ASSERT_EQ(record.tables.rows<sensors::ImageRow>().size(), 5U);
  EXPECT_THAT(record.reading_notes, testing::IsEmpty());
  const sensors::ImageRow& first = record.tables.rows<sensors::ImageRow>().front();
  EXPECT_EQ(first.status, telemetry_image::kStatusNoTarget);
  EXPECT_EQ(first.star_method, telemetry_image::kStarMethodLostInSpace);
  EXPECT_NEAR(first.attitude_sigma, 0.41075991275213863 * kArcsecond, 1e-18);
  EXPECT_EQ(first.covariance_a_roe[0], 9846.780724292774);
  EXPECT_EQ(first.covariance_a_roe[20], 40009.93382449952);
  EXPECT_EQ(first.fate, telemetry_image::kEditRejected) << "the column `used` was 0";
  EXPECT_EQ(record.tables.rows<sensors::ObjectRow>().size(), 10U);
}

TEST(EarlierRuns, PosesAndGnssAreRead) {
  const RunRecord poses = earlier_run("experiment2");
  EXPECT_EQ(poses.tables.rows<sensors::PoseRow>().size(), 3U);
  EXPECT_EQ(poses.tables.rows<sensors::KeypointRow>().size(), 33U);
  EXPECT_GT(poses.tables.rows<sensors::PoseRow>().back().covariance_a_roe[0], 0.0);
  const RunRecord gnss = earlier_run("experiment3");
  EXPECT_EQ(gnss.tables.rows<sensors::GnssRow>().size(), 8U);
  EXPECT_EQ(gnss.tables.rows<sensors::GnssRow>().front().messages, 3);
  EXPECT_EQ(gnss.tables.rows<sensors::GnssRow>().front().obstacle, telemetry_gnss::kObstacleNone);
  EXPECT_EQ(gnss.summary.telemetry_sha256.substr(0, 16), "6d63806d94a5a9ca");
}

TEST(EarlierRuns, HaveAReport) {
  for (const char* name : {"experiment1", "experiment2", "experiment3"}) {
    RunRecord record = earlier_run(name);
    evaluate(record);
    EXPECT_EQ(record.summary.sensor_figures.contains("images"), std::string_view(name) == "experiment1") << name;
    EXPECT_THAT(html_report(record), testing::HasSubstr(name));
  }
}

}  // namespace

}  // namespace vbar::report::test
