#include "host_sim/report/run_tables.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "fsw/math/math.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/text_file.h"

namespace vbar::report {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

enum class Rows { kGrow, kChange };            ///< change: until the end of the run
enum class Presence { kAlways, kIfNotEmpty };  ///< of the file, once the run has ended

template <class Row>
struct Table {
  const char* file;
  std::vector<Row> RunRecord::*rows;
  Rows kind;
  Presence presence;
};

/// The one list of tables.
constexpr std::tuple kTables{
    Table{"waypoints.csv", &RunRecord::waypoints, Rows::kChange, Presence::kAlways},
    Table{"truth.csv", &RunRecord::truth, Rows::kGrow, Presence::kAlways},
    Table{"attitude.csv", &RunRecord::attitudes, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"estimate.csv", &RunRecord::estimates, Rows::kGrow, Presence::kAlways},
    Table{"gnss.csv", &RunRecord::gnss, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"images.csv", &RunRecord::images, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"objects.csv", &RunRecord::objects, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"poses.csv", &RunRecord::poses, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"keypoints.csv", &RunRecord::keypoints, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"gallery.csv", &RunRecord::gallery, Rows::kChange, Presence::kIfNotEmpty},
    Table{"maneuvers.csv", &RunRecord::maneuvers, Rows::kChange, Presence::kAlways},
    Table{"residuals.csv", &RunRecord::residuals, Rows::kGrow, Presence::kIfNotEmpty},
    Table{"notes.csv", &RunRecord::notes, Rows::kGrow, Presence::kIfNotEmpty},
};

template <class Message>
std::string file_of(const std::vector<TelemetryRow<Message>>& /*rows*/) {
  return std::string(Message::getTypeName()) + ".csv";
}

/// Calls visit(file name, rows, kind, presence) for every table of the record.
template <class Record, class Visit>
void for_each_table(Record& record, const Visit& visit) {
  std::apply(
      [&](const auto&... table) {
        (visit(std::string(table.file), record.*table.rows, table.kind, table.presence), ...);
      },
      kTables);
  std::apply([&](auto&... rows) { (visit(file_of(rows), rows, Rows::kGrow, Presence::kIfNotEmpty), ...); },
             record.telemetry);
}

/// A column of files made by an older version: its values times `factor` plus `offset` are those of the new one. A star
/// stands for the same part of both names.
struct OldColumn {
  std::string_view file, old_name, new_name;
  double factor = 1.0;
  int offset = 0;
};

using fsw::math::kArcsecond;
constexpr OldColumn kOldColumns[] = {
    {"images.csv", "attitude_sigma_arcsec", "attitude_sigma_rad", kArcsecond},
    {"images.csv", "bearing_sigma_arcsec", "bearing_sigma_rad", kArcsecond},
    {"images.csv", "prefit_*_arcsec", "prefit_*_rad", kArcsecond},
    {"images.csv", "postfit_*_arcsec", "postfit_*_rad", kArcsecond},
    {"images.csv", "used", "fate", 1.0, 1},  // 0 was refused or none
    {"images.csv", "covariance_a_roe_m2_*", "covariance_a_roe_*_m2"},
    {"poses.csv", "covariance_a_roe_m2_*", "covariance_a_roe_*_m2"},
};

/// The new name of an old column; nothing if the column is not the one that `old` means.
std::optional<std::string> new_name(const OldColumn& old, std::string_view name) {
  const std::size_t star = old.old_name.find('*');
  if (star == std::string_view::npos)
    return name == old.old_name ? std::optional(std::string(old.new_name)) : std::nullopt;
  const std::string_view before = old.old_name.substr(0, star), after = old.old_name.substr(star + 1);
  if (!name.starts_with(before) || !name.ends_with(after) || name.size() <= before.size() + after.size())
    return std::nullopt;
  std::string text(old.new_name);
  text.replace(text.find('*'), 1, name.substr(before.size(), name.size() - before.size() - after.size()));
  return text;
}

[[noreturn]] void fail(const fs::path& file, std::size_t line, const std::string& what) {
  throw std::runtime_error(fmt::format("{}:{}: {}", file.string(), line, what));
}

template <class Row>
Names column_names() {
  Names names;
  const Row row;
  const auto collect = [&](const ColumnName& name, const auto&) { names.push_back(name.text()); };
  visit_columns(row, collect);
  return names;
}

template <class Row>
std::string head_line() {
  return fmt::format("{}\n", fmt::join(column_names<Row>(), ","));
}

template <class Row>
void append_rows(std::string& text, const std::vector<Row>& rows, std::size_t from) {
  for (std::size_t k = from; k < rows.size(); ++k) {
    bool first = true;
    const auto append = [&](const ColumnName&, const auto& value) {
      if (!first) text += ',';
      first = false;
      append_value(text, value);
    };
    visit_columns(rows[k], append);
    text += '\n';
  }
}

template <class Row>
std::string text_of(const std::vector<Row>& rows) {
  std::string text = head_line<Row>();
  append_rows(text, rows, 0);
  return text;
}

/// Where a column of the row stands in the file, and what it was called and measured in there.
struct Source {
  std::optional<std::size_t> cell;
  const OldColumn* old = nullptr;
};

std::vector<Source> sources_of(const fs::path& file, const std::string& table, const Names& wanted, const Names& found,
                               Names& notes) {
  std::vector<Source> sources(wanted.size());
  Names unknown;
  for (std::size_t cell = 0; cell < found.size(); ++cell) {
    Source source{cell, nullptr};
    auto place = std::ranges::find(wanted, found[cell]);
    for (const OldColumn& old : kOldColumns) {
      if (place != wanted.end() || old.file != table) continue;
      const auto renamed = new_name(old, found[cell]);
      if (!renamed) continue;
      place = std::ranges::find(wanted, *renamed);
      source.old = &old;
    }
    if (place == wanted.end()) {
      unknown.push_back(found[cell]);
      continue;
    }
    Source& taken = sources[static_cast<std::size_t>(place - wanted.begin())];
    if (taken.cell) fail(file, 1, fmt::format("column \"{}\" stands there twice", *place));
    taken = source;
  }
  if (!unknown.empty())
    notes.push_back(fmt::format("{}: ignored unknown columns {}", file.string(), fmt::join(unknown, ", ")));
  return sources;
}

template <class Value>
void convert(Value& value, const OldColumn& old) {
  if constexpr (std::is_same_v<Value, std::optional<double>>) {
    if (value) convert(*value, old);
  } else if constexpr (std::is_floating_point_v<Value>) {
    value = static_cast<Value>(static_cast<double>(value) * old.factor);
  } else if constexpr (requires { value.codes; }) {
    value.value = static_cast<std::remove_reference_t<decltype(value.value)>>(value.value + old.offset);
  }
}

/// Takes the cells of a line in the order of the row's columns.
struct CellReader {
  const fs::path& file;
  std::size_t line;
  const Names& cells;
  const std::vector<Source>& sources;
  std::size_t next = 0;

  template <class Value>
  void operator()(const ColumnName& name, Value&& value) {
    const Source& source = sources[next++];
    if (!source.cell) return;
    const std::string& cell = cells[*source.cell];
    if (!read_value(cell, value))
      fail(file, line, fmt::format("{} is \"{}\", which is no value of that column", name.text(), cell));
    if (source.old != nullptr) convert(value, *source.old);
  }
};

/// `cut_short`: the last line may be half a row, for the program was killed.
template <class Row>
std::vector<Row> read_rows(const fs::path& file, const std::string& table, bool cut_short, Names& notes) {
  Names lines = read_lines(file);
  if (cut_short && !lines.empty() && !read_text_file(file).ends_with('\n')) lines.pop_back();
  if (lines.empty()) fail(file, 1, "the file is empty: not even column names");
  Names head, cells;
  if (!split_cells(lines.front(), head)) fail(file, 1, "a quote is not closed");
  const std::vector<Source> sources = sources_of(file, table, column_names<Row>(), head, notes);
  std::vector<Row> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::size_t line = k + 1;
    if (!split_cells(lines[k], cells)) fail(file, line, "a quote is not closed");
    if (cells.size() != head.size()) fail(file, line, fmt::format("{} cells, expected {}", cells.size(), head.size()));
    CellReader reader{file, line, cells, sources};
    visit_columns(rows.emplace_back(), reader);
  }
  return rows;
}

}  // namespace

Names table_files() {
  Names names;
  const RunRecord none;
  for_each_table(none, [&](const std::string& name, const auto&, Rows, Presence) { names.push_back(name); });
  return names;
}

std::string table_text(const RunRecord& record, const std::string& name) {
  std::string text;
  for_each_table(record, [&](const std::string& file, const auto& rows, Rows, Presence) {
    if (file == name) text = text_of(rows);
  });
  return text;
}

template <class Row>
void TableWriter::append(const std::string& name, const std::vector<Row>& rows) {
  const bool is_new = !growing_.contains(name);
  if (is_new) growing_.emplace(name, Growing{PartialFile(folder_ / name)});
  Growing& table = growing_.at(name);
  std::string text = is_new ? head_line<Row>() : "";
  append_rows(text, rows, table.rows);
  table.file.append(text);
  table.rows = rows.size();
}

void TableWriter::update(const RunRecord& record) {
  for_each_table(record, [&](const std::string& name, const auto& rows, Rows kind, Presence) {
    if (rows.empty()) return;
    if (kind == Rows::kChange) return replace_text_file(PartialFile::part_of(folder_ / name), text_of(rows));
    append(name, rows);
    growing_.at(name).file.flush();
  });
}

void TableWriter::finish(const RunRecord& record) {
  for_each_table(record, [&](const std::string& name, const auto& rows, Rows kind, Presence presence) {
    if (kind == Rows::kChange) fs::remove(PartialFile::part_of(folder_ / name));
    if (rows.empty() && presence == Presence::kIfNotEmpty) return;
    if (kind == Rows::kChange) return replace_text_file(folder_ / name, text_of(rows));
    append(name, rows);
    growing_.at(name).file.finish();
  });
  growing_.clear();
}

void read_tables(const fs::path& folder, RunRecord& record) {
  const bool complete = record.summary.complete;
  for_each_table(record, [&](const std::string& name, auto& rows, Rows, Presence presence) {
    using Row = typename std::remove_reference_t<decltype(rows)>::value_type;
    fs::path file = folder / name;
    const bool is_part = !complete && !fs::exists(file);
    if (is_part) file = PartialFile::part_of(file);
    if ((is_part || presence == Presence::kIfNotEmpty) && !fs::exists(file)) return;
    rows = read_rows<Row>(file, name, is_part, record.reading_notes);
  });
}

}  // namespace vbar::report
