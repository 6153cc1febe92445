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
  TableEmbedder embedder;
  embedder.add(table);
  embedder.add(table);
  const nlohmann::json tables = embedder.take();
  EXPECT_EQ(tables[0]["columns"][3]["same"], (nlohmann::json{0, 1}));
  EXPECT_EQ(tables[0]["columns"][1]["bytes"], [&] {
    std::size_t size = 0;
    for (const std::string& cell : table.columns[1].cells) size += cell.size() + 1;
    return size;
  }());
  for (std::size_t column = 0; column < 3; ++column)
    EXPECT_EQ(tables[1]["columns"][column]["same"], (nlohmann::json{0, column}));
}

}  // namespace
}  // namespace vbar::view
