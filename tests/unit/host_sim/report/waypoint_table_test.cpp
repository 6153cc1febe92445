#include "host_sim/report/waypoint_table.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

TEST(WaypointTable, HasALineAWaypointAndOneForAll) {
  const std::vector<std::string> lines = lines_of(waypoint_table(synthetic_run()));
  ASSERT_EQ(lines.size(), 2U + 11U + 1U);
  using testing::ElementsAre;
  EXPECT_THAT(words_of(lines[2]), ElementsAre("start", "0", "0.000", "–", "–", "–", "0.000000", "0.000000", "0"));
  EXPECT_THAT(words_of(lines[2 + 10]),
              ElementsAre("10", "41.250", "1.0000", "0.0909", "0.0100", "0.010000", "1.549768", "4"));
  EXPECT_THAT(words_of(lines.back()), ElementsAre("all", "41.250", "3.834500", "39"));
}

TEST(WaypointTable, NamesAnEmulatedBench) {
  RunRecord record = synthetic_run();
  record.summary.camera = "optical_stimulator";
  record.summary.testbeds["optical_stimulator"]["bench"] = std::string("emulated");
  EXPECT_EQ(lines_of(waypoint_table(record)).front(),
            "figures of an emulated bench: the testbed optical_stimulator was emulated");
}

TEST(WaypointTable, SaysWhenTheRunWasStopped) {
  RunRecord record = synthetic_run();
  record.summary.complete = false;
  EXPECT_THAT(words_of(lines_of(waypoint_table(record)).back()).front(), "stopped");
}

}  // namespace
}  // namespace vbar::report::test
