// Tables inside a page: what a thinned table keeps, and columns that are equal.

#include "host_sim/view/embedded_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::view {
namespace {

using testing::Contains;

/// A slow oscillation with a spike of one row up and one down, and gaps.
CellTable long_table(std::size_t rows, std::size_t spike, std::size_t dip) {
  CellTable table{"a.csv", {{"time_s", "", {}}, {"value", "", {}}, {"word", "", {}}}};
  for (std::size_t row = 0; row < rows; ++row) {
    const double value = row == spike ? 9.0 : row == dip ? -9.0 : std::sin(1e-3 * static_cast<double>(row));
    table.columns[0].cells.push_back(fmt::format("{}", 10 * row));
    table.columns[1].cells.push_back(row % 7 == 3 && row != spike && row != dip ? "" : fmt::format("{}", value));
    table.columns[2].cells.push_back("aiding");
  }
  return table;
}

TEST(EmbeddedTable, AShortTableKeepsAllRows) {
  const CellTable table = long_table(100, 1, 2);
  EXPECT_EQ(rows_to_keep(table, 100).size(), 100u);
}

TEST(EmbeddedTable, AThinnedTableKeepsExtremesAndBothEnds) {
  const CellTable table = long_table(50000, 12345, 31234);
  const std::vector<std::size_t> rows = rows_to_keep(table, 1000);
  EXPECT_LE(rows.size(), 1001u);
  EXPECT_GE(rows.size(), 400u);
  EXPECT_TRUE(std::ranges::is_sorted(rows));
  for (const std::size_t row : std::array<std::size_t, 4>{0, 12345, 31234, 49999}) EXPECT_THAT(rows, Contains(row));
}

TEST(EmbeddedTable, RowsOfAPictureStayTogether) {
  const CellTable table = long_table(50000, 1, 2);
  const std::vector<std::size_t> rows = rows_to_keep(table, 1000, {"77770", "77780"});
  EXPECT_THAT(rows, Contains(7777u));
  EXPECT_THAT(rows, Contains(7778u));
}

TEST(EmbeddedTable, EqualColumnsAreThereOnce) {
  CellTable table = long_table(10, 1, 2);
  table.columns.push_back({"again", "", table.columns[1].cells});
  const nlohmann::json tables = embedded(std::vector{table, table});
  EXPECT_EQ(tables[0]["columns"][3]["same"], (nlohmann::json{0, 1}));
  for (std::size_t column = 0; column < 3; ++column)
    EXPECT_EQ(tables[1]["columns"][column]["same"], (nlohmann::json{0, column}));
}

/// The second table differs from the first in one row, as an estimate that is withdrawn at times from the telemetry.
TEST(EmbeddedTable, AColumnOfTheSameNameIsADifference) {
  CellTable first{"a.csv", {{"x_m", "", {}}}}, second{"b.csv", {{"x_m", "", {}}}};
  for (int row = 0; row < 1000; ++row) {
    first.columns[0].cells.push_back(fmt::format("{}", std::sin(row)));
    second.columns[0].cells.push_back(row == 500 ? "" : first.columns[0].cells.back());
  }
  const nlohmann::json tables = embedded(std::vector{first, second});
  EXPECT_EQ(tables[0]["columns"][0]["form"], "number");
  EXPECT_EQ(tables[1]["columns"][0]["form"], "difference");
  EXPECT_EQ(tables[1]["columns"][0]["of"], (nlohmann::json{0, 0}));
  EXPECT_LT(tables[1]["data"].get<std::string>().size(), tables[0]["data"].get<std::string>().size() / 20);
}

/// binary64 holds integers of up to 2^53 = 9.007e15: GPS times in ns are longer and stay text, as do words.
TEST(EmbeddedTable, WhatBinary64DoesNotHoldStaysText) {
  CellTable table{"a.csv", {{"time_gps_ns", "", {}}, {"word", "", {}}, {"value", "", {}}}};
  for (int row = 0; row < 100; ++row) {
    table.columns[0].cells.push_back(fmt::format("9355680150000000{:02}", row));
    table.columns[1].cells.push_back(row % 2 == 0 ? "on" : "off");
    table.columns[2].cells.push_back(row % 3 == 0 ? "nan" : "0.1");
  }
  for (const nlohmann::json tables = embedded(std::vector{table}); const auto& column : tables[0]["columns"])
    EXPECT_EQ(column["form"], "text");
}

TEST(EmbeddedTable, TheLongestTableIsThinnedFirst) {
  const CellTable longer = long_table(20000, 1, 2), shorter = long_table(300, 1, 2);
  const nlohmann::json whole = embedded(std::vector{longer, shorter});
  EXPECT_EQ(whole[0]["rows"], 20000);
  const nlohmann::json thinned = embedded(std::vector{longer, shorter}, 20000);
  EXPECT_LE(thinned[0]["data"].get<std::string>().size() + thinned[1]["data"].get<std::string>().size(), 20000u);
  EXPECT_LT(thinned[0]["rows"], 10000);
  EXPECT_EQ(thinned[1]["rows"], 300);
}

}  // namespace
}  // namespace vbar::view
