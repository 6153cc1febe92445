#pragma once
// Tables of a run inside a page, column by column: the numbers of the CSV files, so that the page has the same bits as
// any other reader of the file.

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
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
  std::string name{};            ///< of a table without a file
  std::size_t rows_of_file = 0;  ///< if these are not all rows of the file, their number

  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().cells.size(); }
};

/// Rows of a table that a page holds in full, if all tables together are not too long.
inline constexpr std::size_t kMaxRows = 20000;

/// Returns the rows that the page holds of a longer table, ascending: of each of many equal parts the first row and
/// those in which a column has its minimum or maximum, and all whose first cell is one of `whole`. No extreme value is
/// lost.
[[nodiscard]] std::vector<std::size_t> rows_to_keep(const CellTable& table, std::size_t most,
                                                    const std::set<std::string>& whole = {});

/// Bytes of the tables of a run in a page, as base64.
inline constexpr std::size_t kMaxTableBytes = 2'300'000;

using Bits = std::vector<std::uint64_t>;  ///< of numbers as binary64

/// Makes the JSON of tables one after the other. A column with the same cells as an earlier one is a reference to it;
/// another one of numbers has the shortest of these forms: its cells as text, the bytes of its numbers, those of the
/// differences between the bits of consecutive rows, or from the bits of the column of the same name before it, as an
/// estimate is near the truth.
class TablesInPage {
 public:
  void add(const CellTable& table, const std::vector<std::size_t>& rows);
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] nlohmann::json take() { return std::move(tables_); }

 private:
  struct Place {
    std::size_t table = 0, column = 0;
  };
  struct Named {
    Place place;
    Bits bits;
  };
  /// Appends the bytes of a column to those of its table and returns their form.
  nlohmann::json add(const std::vector<std::string>& cells, const std::vector<std::size_t>& rows,
                     const std::string& name, Place place, std::string& data);

  std::map<std::string, Place> places_;  ///< by the cells, joined
  std::map<std::string, Named> named_;   ///< the last column of numbers of each name
  nlohmann::json tables_ = nlohmann::json::array();
  std::size_t size_ = 0;
};

/// Returns the JSON of the tables. If it were longer than `most_bytes`, all tables are limited to the number of rows at
/// which it is not: the longest ones are thinned first. Rows at the times `whole` are always kept: those of the
/// pictures, for what is drawn on them.
[[nodiscard]] nlohmann::json embedded(std::span<const CellTable> tables, std::size_t most_bytes = kMaxTableBytes,
                                      const std::set<std::string>& whole = {});

}  // namespace vbar::view
