// Errors, sigmas and consistency figures at selected times.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/report/extension.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summarise.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report {

namespace {

using Kind = ConsistencyFigure::Kind;

std::vector<ConsistencyFigure> figures(const RunRecord& /*record*/) {
  return {{3600.0, Kind::kNees, 6.5, 6.0},
          {3600.0, Kind::kNis, 21.0, 20.0},
          {3660.0, Kind::kNees, 5.5, 6.0},
          {3660.0, Kind::kNis, 11.0, 10.0},
          {3670.0, Kind::kNis, 3.0, 0.0}};
}
const Extension kModule{.consistency = figures};
const Extension* const kModules[] = {&kModule};

/// A step a minute from the first hour on; the estimate is off by (1, 2, 2) mm and (0, 3, 4) um/s. The third is
/// invalid.
RunRecord record(std::vector<double> sample_hours) {
  RunRecord record;
  record.extensions = kModules;
  for (int step = 0; step < 4; ++step) {
    TruthRow truth;
    truth.time_s = 3600.0 + 60.0 * step;
    truth.relative_position_rtn = {10.0, 0.0, 0.0};
    record.truth.push_back(truth);
    EstimateRow estimate;
    estimate.time_s = truth.time_s;
    estimate.navigation_valid = step == 2 ? 0 : 1;
    estimate.relative_position_rtn = {10.001, 0.002, 0.002};
    estimate.relative_velocity_rtn = {0.0, 3e-6, 4e-6};
    estimate.sigma_rtn = {0.003, 0.004, 0.012, 1e-6, 2e-6, 2e-6};
    record.estimates.push_back(estimate);
  }
  for (const double hour : sample_hours) record.summary.samples.push_back({.time_h = hour});
  return record;
}

Summary summary_of(const RunRecord& record) {
  Summary summary = record.summary;
  summarise_consistency(record, summary);
  return summary;
}

TEST(Samples, StateTheEstimateOfTheLastStep) {
  const Sample sample = summary_of(record({1.0 + 90.0 / 3600.0})).samples.at(0);  // half a minute after the second step
  EXPECT_NEAR(sample.navigation_error_m.value(), 0.003, 1e-12);
  EXPECT_NEAR(sample.navigation_error_r_m.value(), 0.001, 1e-12);
  EXPECT_NEAR(sample.navigation_velocity_error_mps.value(), 5e-6, 1e-15);
  EXPECT_NEAR(sample.sigma_m.value(), 0.013, 1e-12);
  EXPECT_NEAR(sample.sigma_velocity_mps.value(), 3e-6, 1e-15);
}

TEST(Samples, AreAtTheStepOfTheirOwnTime) {
  RunRecord all = record({1.0 + 60.0 / 3600.0});
  all.estimates[1].relative_position_rtn = {10.0, 0.0, 0.5};
  EXPECT_DOUBLE_EQ(summary_of(all).samples.at(0).navigation_error_m.value(), 0.5);
}

TEST(Samples, HaveNoErrorWithoutAValidEstimate) {
  const Summary summary = summary_of(record({0.5, 1.0 + 120.0 / 3600.0}));
  EXPECT_FALSE(summary.samples.at(0).navigation_error_m) << "before the first step";
  EXPECT_FALSE(summary.samples.at(1).navigation_error_m) << "navigation was invalid";
  EXPECT_FALSE(summary.samples.at(1).sigma_m);
}

TEST(Samples, TakeEachConsistencyFigureOnce) {
  const Summary summary = summary_of(record({1.0, 1.0 + 61.0 / 3600.0, 1.05}));
  EXPECT_EQ(summary.samples.at(0).nees, 6.5);
  EXPECT_EQ(summary.samples.at(0).nis, 21.0);
  EXPECT_EQ(summary.samples.at(0).nis_dimension, 20.0);
  EXPECT_EQ(summary.samples.at(1).nees, 5.5);
  EXPECT_EQ(summary.samples.at(1).nees_dimension, 6.0);
  EXPECT_FALSE(summary.samples.at(2).nees) << "nothing since the sample before";
  EXPECT_FALSE(summary.samples.at(2).nis) << "an update without measurements is none";
}

TEST(Samples, OfTheWholeRunAreMeans) {
  const Summary summary = summary_of(record({}));
  EXPECT_EQ(summary.navigation_nees_dimension, 6.0);
  EXPECT_EQ(summary.navigation_nis, 16.0);
  EXPECT_EQ(summary.navigation_nis_dimension, 15.0);
}

}  // namespace

// What a module outside this library adds: a table, figures of the summary, a section, all of them read back.

struct TideRow {
  double time_s = 0.0;
  std::optional<double> height_m;
};

template <columns::RowOf<TideRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(ColumnName{"time_s", "since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"height_m", "of the tide"}, row.height_m);
}

namespace {

constexpr OldColumn kOldTides[] = {{"height_cm", "height_m", 0.01}};

constexpr Extension kTides{
    .tables =
        [] {
          return std::vector{table_of_extension<TideRow>("tides.csv", Rows::kGrow, Presence::kIfNotEmpty, kOldTides)};
        },
    .summarise =
        [](const RunRecord& record, Summary& summary) {
          summary.sensor_figures["gauge"]["count"] = static_cast<double>(record.tables.rows<TideRow>().size());
        },
    .sections =
        [](const RunRecord& record) {
          return std::vector<Section>{
              record.tables.rows<TideRow>().empty() ? Section{} : Section{"Tides", "<p>high</p>", {"tides.csv"}}};
        },
};
constexpr Extension kNothing{};
constexpr const Extension* kAll[] = {&kNothing, &kTides};

class ExtensionTest : public test::ScratchFolder {
 protected:
  [[nodiscard]] std::filesystem::path run() const { return scratch_ / "run"; }
  RunRecord with_tides() {
    RunRecord record = test::synthetic_run();
    record.extensions = kAll;
    record.tables.rows<TideRow>() = {{1.0, 2.5}, {2.0, std::nullopt}};
    return record;
  }
};

TEST_F(ExtensionTest, IsWrittenReadBackAndReported) {
  RunRecord record = with_tides();
  record.summary = summarise(record);
  RunFolder folder(run(), {}, RunFolder::Existing::kReplace, kAll);
  folder.update(record);
  record.tables.rows<TideRow>().push_back({3.0, -1.0});
  folder.finish(record);
  const RunRecord read = read_run(run(), kAll);
  ASSERT_EQ(read.tables.rows<TideRow>().size(), 3U);
  EXPECT_EQ(read.tables.rows<TideRow>()[0].height_m, 2.5);
  EXPECT_EQ(read.tables.rows<TideRow>()[1].height_m, std::nullopt);
  EXPECT_EQ(read.tables.rows<TideRow>()[2].time_s, 3.0);
  EXPECT_EQ(read.summary.sensor_figures.at("gauge").at("count"), 2.0);
  EXPECT_EQ(summarise(read).sensor_figures.at("gauge").at("count"), 3.0);
  EXPECT_THAT(html_report(read), testing::HasSubstr("Tides"));
  EXPECT_THAT(html_report(read_run(run())), testing::Not(testing::HasSubstr("Tides")));
}

TEST_F(ExtensionTest, ItsFilesOfAnEarlierRunAreRemoved) {
  { RunFolder(run(), {}, RunFolder::Existing::kReplace, kAll).finish(with_tides()); }
  EXPECT_TRUE(std::filesystem::exists(run() / "tides.csv"));
  const RunFolder again(run(), {}, RunFolder::Existing::kReplace, kAll);
  EXPECT_FALSE(std::filesystem::exists(run() / "tides.csv"));
}

TEST_F(ExtensionTest, ItsOlderColumnsAreConverted) {
  { RunFolder(run(), {}, RunFolder::Existing::kReplace, kAll).finish(with_tides()); }
  write(run() / "tides.csv", "height_cm,time_s\n250,4\n");
  EXPECT_EQ(read_run(run(), kAll).tables.rows<TideRow>().at(0).height_m, 2.5);
  write(run() / "tides.csv", "height_m,time_s\n1,2\nhigh,3\n");
  try {
    static_cast<void>(read_run(run(), kAll));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("tides.csv:3: height_m is \"high\""));
  }
}

}  // namespace

}  // namespace vbar::report
