#pragma once
// A table of the run folder: its file, and how its rows are written and read by their visit_columns (run_columns.h).

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/run_tables.h"

namespace vbar::report {

enum class Rows { kGrow, kChange };            ///< change: until the end of the run
enum class Presence { kAlways, kIfNotEmpty };  ///< presence of the file, once the run has ended

/// A column of files made by an older version: its values times `factor` plus `offset` are those of the new one. A star
/// stands for the same part of both names.
struct OldColumn {
  std::string_view old_name, new_name;
  double factor = 1.0;
  int offset = 0;
};

/// Where a column of the row stands in the file, and what it was called and measured in there.
struct CellSource {
  std::optional<std::size_t> cell;
  const OldColumn* old = nullptr;
};

/// Takes the cells of a line in the order of the row's columns.
struct CellReader {
  const std::vector<std::string>& cells;
  const std::vector<CellSource>& sources;
  std::string refused = {};  ///< the first cell that holds no value of its column, in words
  std::size_t next = 0;

  template <class Value>
  void operator()(const ColumnName& name, Value&& value) {
    const CellSource& source = sources[next++];
    if (!source.cell || !refused.empty()) return;
    const std::string& cell = cells[*source.cell];
    if (!read_value(cell, value)) {
      refused = fmt::format("{} is \"{}\", which is no value of that column", name.text(), cell);
    } else if (source.old != nullptr) {
      convert(value, *source.old);
    }
  }

 private:
  template <class Value>
  static void convert(Value& value, const OldColumn& old) {
    if constexpr (std::is_same_v<Value, std::optional<double>>) {
      if (value) convert(*value, old);
    } else if constexpr (std::is_floating_point_v<Value>) {
      value = static_cast<Value>(static_cast<double>(value) * old.factor);
    } else if constexpr (requires { value.codes; }) {
      value.value = static_cast<std::remove_reference_t<decltype(value.value)>>(value.value + old.offset);
    }
  }
};

struct TableKind {
  std::string file;
  Rows rows;
  Presence presence;
  std::span<const OldColumn> old_columns;
  std::vector<TableColumn> (*columns)();
  std::size_t (*count)(const RunRecord& record);
  void (*append)(const RunRecord& record, std::size_t row, std::string& line);
  void (*read)(RunRecord& record, CellReader& cells);  ///< appends one row
};

/// The table of the rows std::invoke(kRowsOf, record).
template <auto kRowsOf>
TableKind table_kind(std::string file, Rows rows = Rows::kGrow, Presence presence = Presence::kIfNotEmpty,
                     std::span<const OldColumn> old_columns = {}) {
  using Row = typename std::remove_cvref_t<std::invoke_result_t<decltype(kRowsOf), RunRecord&>>::value_type;
  TableKind table{std::move(file), rows, presence, old_columns, nullptr, nullptr, nullptr, nullptr};
  table.columns = [] {
    std::vector<TableColumn> columns;
    const Row row;
    const auto collect = [&](const ColumnName& name, const auto&) {
      columns.push_back({name.text(), std::string(name.meaning), std::string(name.stem)});
    };
    visit_columns(row, collect);
    return columns;
  };
  table.count = [](const RunRecord& record) { return std::invoke(kRowsOf, record).size(); };
  table.append = [](const RunRecord& record, std::size_t row, std::string& line) {
    bool first = true;
    const auto append = [&](const ColumnName&, const auto& value) {
      if (!first) line += ',';
      first = false;
      append_value(line, value);
    };
    visit_columns(std::invoke(kRowsOf, record)[row], append);
  };
  table.read = [](RunRecord& record, CellReader& cells) {
    visit_columns(std::invoke(kRowsOf, record).emplace_back(), cells);
  };
  return table;
}

template <class Row>
struct RowsOfExtension {
  auto& operator()(auto& record) const { return record.tables.template rows<Row>(); }
};

/// The table of an extension's rows, record.tables.rows<Row>().
template <class Row>
TableKind table_of_extension(std::string file, Rows rows = Rows::kGrow, Presence presence = Presence::kIfNotEmpty,
                             std::span<const OldColumn> old_columns = {}) {
  return table_kind<RowsOfExtension<Row>{}>(std::move(file), rows, presence, old_columns);
}

}  // namespace vbar::report
