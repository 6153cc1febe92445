#pragma once
// Tables of a run inside a page: the cells of the CSV files as they are, column by column, so that the page reads the
// same bits as any other reader of the file.

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace vbar::view {

/// Returns bytes compressed (RFC 1950) as base64.
[[nodiscard]] std::string packed(std::string_view bytes);

struct CellColumn {
  std::string name, meaning;
  std::vector<std::string> cells;
};

/// A table, its first column the time in s since the epoch of the mission if it is a function of time.
struct CellTable {
  std::string file;  ///< of the run folder; empty: the table is in the page only
  std::vector<CellColumn> columns;

  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().cells.size(); }
};

/// Rows of a table that a page holds in full.
inline constexpr std::size_t kMaxRows = 20000;

/// Returns the rows that the page holds of a longer table, ascending: of each of many equal parts the first row and
/// those in which a column has its minimum or maximum, and all whose first cell is one of `whole`. No extreme value is
/// lost.
[[nodiscard]] std::vector<std::size_t> rows_to_keep(const CellTable& table, std::size_t most,
                                                    const std::set<std::string>& whole = {});

/// Makes the JSON of tables one after the other. A column with the same cells as an earlier one is a reference to it.
class TableEmbedder {
 public:
  /// Times whose rows are always kept: those of the pictures, for what is drawn on them.
  explicit TableEmbedder(std::set<std::string> whole_times = {}) : whole_times_(std::move(whole_times)) {}

  void add(const CellTable& table);
  [[nodiscard]] nlohmann::json take() { return std::move(tables_); }

 private:
  struct Place {
    std::size_t table = 0, column = 0;
  };
  std::set<std::string> whole_times_;
  std::map<std::string, Place> places_;  ///< by the cells, joined
  nlohmann::json tables_ = nlohmann::json::array();
};

}  // namespace vbar::view
