// What a module outside this library adds: a table, figures of the summary, a section, all of them read back.

#include "host_sim/report/extension.h"

#include <gmock/gmock.h>

#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/summarise.h"
#include "tests/unit/host_sim/report/scratch_folder.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report {

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
