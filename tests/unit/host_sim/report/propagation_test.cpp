// What a propagation leaves: ephemerides as CSV and as CCSDS OEM, and a folder that says whether they are whole.

#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/propagation_folder.h"
#include "host_sim/truth/earth/time_scales.h"
#include "tests/support/figures.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

class Propagated : public ScratchFolder {};

EphemerisRow row_at(double seconds) {
  EphemerisRow row;
  row.time = truth::gps_from_utc("2012-06-30T23:59:50Z") + fsw::nearest_duration(seconds);
  row.time_s = seconds;
  row.state.position_eci << -7000123.456789012, 1.0 / 3.0, 1e-7 - seconds;
  row.state.velocity_eci << -1068.5690877908, 7433.7358593127, 0.0;
  row.geodetic = {-0.5, 3.0, 698535.25};
  return row;
}

/// Rows across a leap second.
std::vector<EphemerisRow> rows() {
  return {row_at(0.0), row_at(10.5), row_at(60.0), row_at(120.123456789)};
}

OemFile::Span span_of(const std::vector<EphemerisRow>& all) {
  return {all.front().time, all.back().time, all.size(), truth::gps_from_utc("2026-01-02T03:04:05Z")};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST_F(Propagated, CsvReadsBackTheSameBits) {
  EphemerisCsv csv(scratch_ / "a.csv");
  for (const EphemerisRow& row : rows()) csv.append(row);
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "a.csv")) << "not whole yet";
  csv.finish();
  const std::vector<std::string> lines = read_lines(scratch_ / "a.csv");
  ASSERT_EQ(lines.size(), 1 + rows().size());
  std::vector<std::string> cells;
  ASSERT_TRUE(split_cells(lines[0], cells));
  EXPECT_EQ(cells.size(), 11U);
  for (std::size_t k = 0; k < rows().size(); ++k) {
    const EphemerisRow row = rows()[k];
    ASSERT_TRUE(split_cells(lines[k + 1], cells));
    ASSERT_EQ(cells.size(), 11U);
    EXPECT_EQ(std::stod(cells[0]), row.time_s);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(std::stod(cells[static_cast<std::size_t>(2 + axis)]), row.state.position_eci[axis]);
      EXPECT_EQ(std::stod(cells[static_cast<std::size_t>(5 + axis)]), row.state.velocity_eci[axis]);
    }
    EXPECT_NEAR(std::stod(cells[8]), -28.64788975654116, 1e-13);  // -0.5 rad and 3 rad in degrees, rounding
    EXPECT_NEAR(std::stod(cells[9]), 171.88733853924697, 1e-12);
    EXPECT_EQ(std::stod(cells[10]), 698535.25);
  }
  EXPECT_THAT(lines[2], testing::HasSubstr(",2012-06-30T23:59:60.500Z,"));
}

// The grammar of CCSDS 502.0-B-2: keywords and their order by its tables 5-2 and 5-3, lines by sections 5.2.4 and 6.2
// to 6.5: printable ASCII, at most 254 characters, times without a zone, numbers with at most 16 digits.
TEST_F(Propagated, OemKeepsToTheStandardsGrammar) {
  OemFile oem(scratch_ / "a.oem", "mango", span_of(rows()));
  for (const EphemerisRow& row : rows()) oem.append(row);
  oem.finish();
  const std::string text = content(scratch_ / "a.oem");
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~'));

  const std::string time = "[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\\.[0-9]+)?";
  const std::string number = "[+-]?[0-9]{1,15}\\.[0-9]{1,15}";
  const std::vector<std::string> grammar{"CCSDS_OEM_VERS = 2\\.0",
                                         "CREATION_DATE = " + time,
                                         "ORIGINATOR = [A-Z]+",
                                         "",
                                         "META_START",
                                         "OBJECT_NAME = [^ ].*",
                                         "OBJECT_ID = [^ ].*",
                                         "CENTER_NAME = EARTH",
                                         "REF_FRAME = (EME2000|GCRF|ICRF|ITRF2000|TOD|TEME)",
                                         "TIME_SYSTEM = (GPS|TAI|TT|UT1|UTC)",
                                         "START_TIME = " + time,
                                         "STOP_TIME = " + time,
                                         "INTERPOLATION = HERMITE",
                                         "INTERPOLATION_DEGREE = [0-9]+",
                                         "META_STOP",
                                         ""};
  const std::vector<std::string> lines = lines_of(text);
  ASSERT_EQ(lines.size(), grammar.size() + rows().size());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    EXPECT_LE(lines[k].size(), 254U);
    const std::string& expected = k < grammar.size() ? grammar[k] : time + "( " + number + "){6}";
    EXPECT_THAT(lines[k], testing::MatchesRegex(expected));
  }
  EXPECT_EQ(lines[1], "CREATION_DATE = 2026-01-02T03:04:05");
  EXPECT_EQ(lines[10], "START_TIME = 2012-06-30T23:59:50.000000000");
  EXPECT_EQ(lines[13], "INTERPOLATION_DEGREE = 7");
  EXPECT_TRUE(lines[17].starts_with("2012-06-30T23:59:60.500000000 ")) << "the leap second";
  EXPECT_TRUE(lines[18].starts_with("2012-07-01T00:00:49.000000000 "));
}

TEST_F(Propagated, OemHoldsTheStatesToAMicrometre) {
  OemFile oem(scratch_ / "a.oem", "mango", span_of(rows()));
  for (const EphemerisRow& row : rows()) oem.append(row);
  oem.finish();
  const std::vector<std::string> lines = lines_of(content(scratch_ / "a.oem"));
  for (std::size_t k = 0; k < rows().size(); ++k) {
    std::istringstream line(lines[lines.size() - rows().size() + k]);
    std::string time;
    fsw::Vector3 r_km, v_kmps;
    line >> time >> r_km.x() >> r_km.y() >> r_km.z() >> v_kmps.x() >> v_kmps.y() >> v_kmps.z();
    EXPECT_EQ(truth::gps_from_utc(time), rows()[k].time);
    // Half of the last digit, 1e-9 km and km/s, and rounding of 7e6 m.
    EXPECT_LT(accuracy::largest_entry(1e3 * r_km - rows()[k].state.position_eci), 0.51e-6);
    EXPECT_LT(accuracy::largest_entry(1e3 * v_kmps - rows()[k].state.velocity_eci), 0.51e-6);
  }
}

PropagationRecord record_of(bool complete) {
  PropagationRecord record;
  record.mission = "m";
  record.complete = complete;
  record.incomplete_reason = complete ? "" : "spacecraft \"a\": re-enters";
  record.simulated_s = 3600.0;
  record.wall_s = 2.0;
  record.spacecraft = {{"a", 5e5, 4.9e5, -3.25, {}}, {"b", 6e5, 6e5, std::nullopt, {}}};
  record.total.force_evaluations = 1000;
  record.total.wall_s = 1.5;
  record.force_times = {{"frames", 0.25}, {"gravity", 0.75}};
  return record;
}

TEST_F(Propagated, AFolderIsWholeOnlyIfThePropagationIs) {
  const std::vector<std::string> names{"a", "b"};
  const OemFile::Span span = span_of(rows());
  const auto fly = [&](bool complete) {
    PropagationFolder folder(scratch_ / "out", "m");
    folder.start_files(names, &span);
    for (const EphemerisRow& row : rows())
      for (std::size_t k = 0; k < names.size(); ++k) folder.append(k, row);
    const auto running = nlohmann::json::parse(content(scratch_ / "out" / "propagation.json"));
    EXPECT_EQ(running.at("complete"), false);
    folder.finish(record_of(complete));
    return nlohmann::json::parse(content(scratch_ / "out" / "propagation.json"));
  };
  const auto broken = fly(false);
  EXPECT_EQ(broken.at("complete"), false);
  EXPECT_EQ(broken.at("incomplete_reason"), "spacecraft \"a\": re-enters");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "out" / "a.csv"));
  EXPECT_EQ(read_lines(scratch_ / "out" / "a.csv.part").size(), 1 + rows().size());

  const auto whole = fly(true);
  EXPECT_EQ(whole.at("complete"), true);
  EXPECT_EQ(whole.at("speed_factor"), 1800.0);
  EXPECT_EQ(whole.at("force_wall_s").at("gravity"), 0.75);
  EXPECT_EQ(whole.at("spacecraft").at(1).at("semi_major_axis_change_by_drag_m"), nullptr);
  for (const auto& file : whole.at("files")) {
    const std::string name = file.get<std::string>();
    EXPECT_TRUE(std::filesystem::exists(scratch_ / "out" / name)) << name;
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "out" / (name + ".part"))) << "of the run before";
  }
}

TEST_F(Propagated, AFolderHoldsMoreEphemeridesThanFilesMayBeOpen) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 32;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<std::string> names;
  for (int k = 0; k < 100; ++k) names.push_back("s" + std::to_string(k));
  constexpr int kRows = 200;  // more than are kept in memory
  PropagationFolder folder(scratch_ / "out", "m");
  folder.start_files(names, nullptr);
  for (int row = 0; row < kRows; ++row)
    for (std::size_t k = 0; k < names.size(); ++k) folder.append(k, row_at(row));
  folder.finish(record_of(true));
  setrlimit(RLIMIT_NOFILE, &before);
  for (const std::string& name : names) {
    const auto lines = read_lines(scratch_ / "out" / (name + ".csv"));
    ASSERT_EQ(lines.size(), 1U + kRows) << name;
    for (int row = 0; row < kRows; ++row)
      EXPECT_TRUE(lines[static_cast<std::size_t>(row) + 1].starts_with(std::to_string(row) + ",")) << name;
  }
}

TEST_F(Propagated, AFolderOfSomethingElseIsNotTouched) {
  write(scratch_ / "precious.txt", "keep me");
  EXPECT_THROW(PropagationFolder(scratch_, "m"), std::runtime_error);
  EXPECT_EQ(content(scratch_ / "precious.txt"), "keep me");
}

TEST_F(Propagated, TheTableTellsWhereTheTimeGoes) {
  const std::string table = propagation_table(record_of(true));
  using testing::HasSubstr;
  EXPECT_THAT(table, HasSubstr("a               500.000      490.000        -3.25"));
  EXPECT_THAT(table, HasSubstr("gravity                  0.750      50.0         750000"));
  EXPECT_THAT(table, HasSubstr("integration              0.500      33.3         500000")) << "what is left of 1.5 s";
  EXPECT_THAT(table, HasSubstr("1,800 times real time"));
}

}  // namespace
}  // namespace vbar::report::test
