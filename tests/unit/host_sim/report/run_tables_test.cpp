#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vbar/fields.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/words.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {

namespace {

using testing::ElementsAre;

template <class Value>
std::string text_of(const Value& value) {
  std::string text;
  append_value(text, value);
  return text;
}

// Every finite double there is may come: bit patterns drawn at random cover signs, exponents and denormal numbers
// alike.
TEST(CsvTable, DoublesComeBackWithTheSameBits) {
  std::mt19937_64 random(1);  // NOLINT: the same numbers in every run
  std::vector<double> values{0.0, -0.0, 0.1, -1.0 / 3.0, 5e-324, 1.7976931348623157e308, 148500.0};
  while (values.size() < 20000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  for (const double value : values) {
    double back = 1.0;
    ASSERT_TRUE(read_value(text_of(value), back)) << text_of(value);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(value)) << text_of(value);
  }
}

TEST(CsvTable, NumbersAreAsShortAsTheyCanBe) {
  EXPECT_EQ(text_of(0.1), "0.1");
  EXPECT_EQ(text_of(60.0), "60");
  EXPECT_EQ(text_of(-2000.5), "-2000.5");
}

TEST(CsvTable, WhatIsNoNumberIsAnEmptyCell) {
  EXPECT_EQ(text_of(std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_EQ(text_of(-std::numeric_limits<double>::infinity()), "");
  EXPECT_EQ(text_of(std::optional<double>{}), "");
  double value = 0.0;
  EXPECT_TRUE(read_value("", value));
  EXPECT_TRUE(std::isnan(value));
  std::optional<double> absent = 1.0;
  EXPECT_TRUE(read_value("", absent));
  EXPECT_FALSE(absent.has_value());
}

TEST(CsvTable, WhatIsNotAllOfANumberIsRefused) {
  double number = 0.0;
  for (const char* cell : {"1.0x", " 1", "1 ", "nan", "inf", "0x10", "1e999", "--1"}) {
    EXPECT_FALSE(read_value(cell, number)) << cell;
  }
  int count = 0;
  for (const char* cell : {"", "1.5", "99999999999", "one"}) EXPECT_FALSE(read_value(cell, count)) << cell;
  bool flag = false;
  for (const char* cell : {"", "2", "true"}) EXPECT_FALSE(read_value(cell, flag)) << cell;
  std::uint64_t large = 0;
  EXPECT_TRUE(read_value("18446744073709551615", large));
  EXPECT_FALSE(read_value("-1", large));
}

// The examples of RFC 4180, section 2.
TEST(CsvTable, QuotesAsInRfc4180) {
  std::vector<std::string> cells;
  EXPECT_TRUE(split_cells("aaa,bbb,ccc", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "bbb", "ccc"));
  EXPECT_TRUE(split_cells(R"("aaa","bbb","ccc")", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "bbb", "ccc"));
  EXPECT_TRUE(split_cells(R"("aaa","b""bb","c,c")", cells));
  EXPECT_THAT(cells, ElementsAre("aaa", "b\"bb", "c,c"));
  EXPECT_TRUE(split_cells(R"(,"",)", cells));
  EXPECT_THAT(cells, ElementsAre("", "", ""));
  EXPECT_FALSE(split_cells(R"(aaa,"bbb)", cells));
  EXPECT_FALSE(split_cells(R"(a"a,b)", cells));
  EXPECT_FALSE(split_cells(R"("a"a,b)", cells));
}

TEST(CsvTable, TextComesBack) {
  for (const std::string text : {"plain", "a,b", "say \"x\"", "", "\"", "\",\""}) {
    std::vector<std::string> cells;
    EXPECT_TRUE(split_cells("1," + text_of(text) + ",2", cells)) << text;
    EXPECT_THAT(cells, ElementsAre("1", text, "2"));
  }
  EXPECT_EQ(text_of(std::string("two\nlines")), "two lines");
}

}  // namespace

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

namespace {

TEST(NavigationErrors, AreEstimateLessTruthOfValidSteps) {
  RunRecord record;
  Vector6 truth = Vector6::Zero();
  truth(1) = -7.0;
  Vector6 estimate = truth;
  estimate(0) = 0.25;
  estimate(5) = -0.5;
  for (const double t : {0.0, 10.0, 20.0}) {
    record.truth.push_back(truth_at(t, truth));
    record.estimates.push_back(estimate_at(t, estimate, 4));
  }
  record.estimates[1].navigation_valid = 0;
  record.estimates.push_back(estimate_at(25.0, estimate, 4));  // no truth of that time
  const std::vector<NavigationError> errors = navigation_errors(record);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[1].time_s, 20.0);
  EXPECT_EQ(errors[1].position_rtn, (Triple{0.25, 0.0, 0.0}));
  EXPECT_EQ(errors[1].velocity_rtn, (Triple{0.0, 0.0, -0.5}));
}

TEST(NavigationErrors, FirstFixIsTheFirstStepByFixedAmbiguities) {
  RunRecord record;
  EXPECT_FALSE(first_fix(record).has_value());
  const Vector6 zero = Vector6::Zero();
  record.estimates = {estimate_at(0.0, zero, 3), estimate_at(10.0, zero, 4), estimate_at(20.0, zero, 4)};
  EXPECT_EQ(first_fix(record), 10.0);
  record.estimates[1].navigation_valid = 0;
  EXPECT_EQ(first_fix(record), 20.0);
}

}  // namespace

// Every word that can be printed is explained.

namespace {

/// All words of codes of a message, nested ones excluded.
template <class Message>
void collect(std::set<std::string>& words) {
  const Message message{};
  visit_fields(message, [&](const Field& field, const auto& /*value*/) {
    for (int k = 0; k < field.codes.count; ++k) words.insert(field.codes.codes[k].word);
  });
}

template <class... Rows>
std::set<std::string> words_of_telemetry(const std::tuple<std::vector<TelemetryRow<Rows>>...>&) {
  std::set<std::string> words;
  (collect<Rows>(words), ...);
  return words;
}

TEST(Words, EveryCodeOfTelemetryIsExplained) {
  std::set<std::string> printed = words_of_telemetry(TelemetryTables{});
  collect<mode_command>(printed);
  collect<waypoint>(printed);
  collect<maneuver_command>(printed);
  EXPECT_GT(printed.size(), 90U);
  EXPECT_TRUE(printed.contains("navigation_timeout"));
  const std::vector<ExplainedWord> explained = explained_words();
  for (const std::string& word : printed) {
    const auto found = std::ranges::find(explained, word, &ExplainedWord::word);
    ASSERT_NE(found, explained.end()) << word;
    EXPECT_GE(found->meaning.size(), 8U) << word;
  }
}

TEST(Words, EveryFaultHasAResponse) {
  int faults = 0;
  for (const ExplainedWord& word : explained_words()) {
    if (word.quantity != "fault") continue;
    ++faults;
    EXPECT_FALSE(word.response.empty()) << word.word;
  }
  EXPECT_EQ(faults, 31);
}

// The table of faults in fsw/faults says: retreat, at two of three checks.
TEST(Words, ResponseIsThatOfTheTableOfFaults) {
  const std::vector<ExplainedWord> explained = explained_words();
  const auto drift = std::ranges::find(explained, "drift_unsafe", &ExplainedWord::word);
  ASSERT_NE(drift, explained.end());
  EXPECT_EQ(drift->response, "retreats, in a mission with [safety], once 2 of 3 checks detect it");
  const auto unsafe = std::ranges::find(explained, "navigation_lost", &ExplainedWord::word);
  ASSERT_NE(unsafe, explained.end());
  EXPECT_EQ(unsafe->quantity, "verdict");
}

}  // namespace

}  // namespace vbar::report::test
