// Run folders of an earlier version (tests/data/earlier_runs/README.md). Expected values are read off its files.

#include <cmath>

#include <gmock/gmock.h>

#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/sensors/gnss/gnss_row.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "tests/support/paths.h"

namespace vbar::report::test {
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
