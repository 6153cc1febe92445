#include "host_sim/report/run_tables.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/run_columns.h"

namespace vbar::report {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

/// The rows of a message of telemetry.
template <class Message>
struct TelemetryRows {
  auto& operator()(auto& record) const { return std::get<std::vector<TelemetryRow<Message>>>(record.telemetry); }
};

/// The table of a message of telemetry.
struct TelemetryTableKind {
  fsw::packets::Apid message;
  TableKind table;
};

template <class Message>
TelemetryTableKind table_of(const std::vector<TelemetryRow<Message>>& /*rows*/) {
  return {fsw::packets::MessageTraits<Message>::kApid,
          table_kind<TelemetryRows<Message>{}>(std::string(Message::getTypeName()) + ".csv")};
}

std::vector<TelemetryTableKind> telemetry_tables() {
  std::vector<TelemetryTableKind> tables;
  std::apply([&](const auto&... rows) { (tables.push_back(table_of(rows)), ...); }, TelemetryTables{});
  return tables;
}

/// The one list of this library's tables.
std::vector<TableKind> own_tables() {
  using enum Rows;
  using enum Presence;
  return {
      table_kind<&RunRecord::waypoints>("waypoints.csv", kChange, kAlways),
      table_kind<&RunRecord::truth>("truth.csv", kGrow, kAlways),
      table_kind<&RunRecord::attitudes>("attitude.csv"),
      table_kind<&RunRecord::estimates>("estimate.csv", kGrow, kAlways),
      table_kind<&RunRecord::gallery>("gallery.csv", kChange),
      table_kind<&RunRecord::maneuvers>("maneuvers.csv", kChange, kAlways),
      table_kind<&RunRecord::residuals>("residuals.csv"),
      table_kind<&RunRecord::notes>("notes.csv"),
      table_kind<&RunRecord::faults>("faults.csv", kChange),
  };
}

/// All tables of a record with these extensions.
std::vector<TableKind> tables_with(Extensions extensions) {
  static const std::vector<TableKind> kOwn = own_tables();
  static const std::vector<TelemetryTableKind> kTelemetry = telemetry_tables();
  std::vector<TableKind> tables = kOwn;
  for (const TelemetryTableKind& telemetry : kTelemetry)
    if (!is_in_table_of_module(extensions, telemetry.message)) tables.push_back(telemetry.table);
  for (const Extension* extension : extensions) {
    if (extension->tables == nullptr) continue;
    std::vector<TableKind> more = extension->tables();
    std::ranges::move(more, std::back_inserter(tables));
  }
  return tables;
}

Names names_of(const TableKind& table) {
  Names names;
  for (TableColumn& column : table.columns()) names.push_back(std::move(column.name));
  return names;
}

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

std::string head_line(const TableKind& table) {
  return fmt::format("{}\n", fmt::join(names_of(table), ","));
}

void append_rows(std::string& text, const TableKind& table, const RunRecord& record, std::size_t from) {
  for (std::size_t row = from; row < table.count(record); ++row) {
    table.append(record, row, text);
    text += '\n';
  }
}

std::string text_of(const TableKind& table, const RunRecord& record) {
  std::string text = head_line(table);
  append_rows(text, table, record, 0);
  return text;
}

std::vector<CellSource> sources_of(const fs::path& file, const TableKind& table, const Names& found, Names& notes) {
  const Names wanted = names_of(table);
  std::vector<CellSource> sources(wanted.size());
  Names unknown;
  for (std::size_t cell = 0; cell < found.size(); ++cell) {
    CellSource source{cell, nullptr};
    auto place = std::ranges::find(wanted, found[cell]);
    for (const OldColumn& old : table.old_columns) {
      if (place != wanted.end()) continue;
      const auto renamed = new_name(old, found[cell]);
      if (!renamed) continue;
      place = std::ranges::find(wanted, *renamed);
      source.old = &old;
    }
    if (place == wanted.end()) {
      unknown.push_back(found[cell]);
      continue;
    }
    CellSource& taken = sources[static_cast<std::size_t>(place - wanted.begin())];
    if (taken.cell) fail(file, 1, fmt::format("column \"{}\" stands there twice", *place));
    taken = source;
  }
  if (!unknown.empty())
    notes.push_back(fmt::format("{}: ignored unknown columns {}", file.string(), fmt::join(unknown, ", ")));
  return sources;
}

/// `cut_short`: the last line may be half a row, for the program was killed.
void read_rows(const fs::path& file, const TableKind& table, bool cut_short, RunRecord& record) {
  Names lines = read_lines(file);
  if (cut_short && !lines.empty() && !files::read_text_file(file).ends_with('\n')) lines.pop_back();
  if (lines.empty()) fail(file, 1, "the file is empty: not even column names");
  Names head, cells;
  if (!split_cells(lines.front(), head)) fail(file, 1, "a quote is not closed");
  const std::vector<CellSource> sources = sources_of(file, table, head, record.reading_notes);
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::size_t line = k + 1;
    if (!split_cells(lines[k], cells)) fail(file, line, "a quote is not closed");
    if (cells.size() != head.size()) fail(file, line, fmt::format("{} cells, expected {}", cells.size(), head.size()));
    CellReader reader{cells, sources};
    table.read(record, reader);
    if (!reader.refused.empty()) fail(file, line, reader.refused);
  }
}

}  // namespace

std::vector<DescribedTable> described_tables(Extensions extensions) {
  std::vector<DescribedTable> described;
  for (const TableKind& table : tables_with(extensions)) described.push_back({table.file, table.columns()});
  return described;
}

Names table_files(Extensions extensions) {
  Names names;
  for (const TableKind& table : tables_with(extensions)) names.push_back(table.file);
  return names;
}

std::string table_text(const RunRecord& record, const std::string& name) {
  for (const TableKind& table : tables_with(record.extensions))
    if (table.file == name) return text_of(table, record);
  return {};
}

void TableWriter::append(const TableKind& table, const RunRecord& record) {
  const bool is_new = !growing_.contains(table.file);
  if (is_new) growing_.emplace(table.file, Growing{files::PartialFile(folder_ / table.file)});
  Growing& growing = growing_.at(table.file);
  std::string text = is_new ? head_line(table) : "";
  append_rows(text, table, record, growing.rows);
  growing.file.append(text);
  growing.rows = table.count(record);
}

void TableWriter::update(const RunRecord& record) {
  for (const TableKind& table : tables_with(record.extensions)) {
    if (table.count(record) == 0) continue;
    if (table.rows == Rows::kChange) {
      files::replace_text_file(files::PartialFile::part_of(folder_ / table.file), text_of(table, record));
      continue;
    }
    append(table, record);
    growing_.at(table.file).file.flush();
  }
}

void TableWriter::finish(const RunRecord& record) {
  for (const TableKind& table : tables_with(record.extensions)) {
    const bool changes = table.rows == Rows::kChange;
    if (changes) fs::remove(files::PartialFile::part_of(folder_ / table.file));
    if (table.count(record) == 0 && table.presence == Presence::kIfNotEmpty) continue;
    if (changes) {
      files::replace_text_file(folder_ / table.file, text_of(table, record));
      continue;
    }
    append(table, record);
    growing_.at(table.file).file.finish();
  }
  growing_.clear();
}

void read_tables(const fs::path& folder, RunRecord& record) {
  const bool complete = record.summary.complete;
  for (const TableKind& table : tables_with(record.extensions)) {
    fs::path file = folder / table.file;
    const bool is_part = !complete && !fs::exists(file);
    if (is_part) file = files::PartialFile::part_of(file);
    if ((is_part || table.presence == Presence::kIfNotEmpty) && !fs::exists(file)) continue;
    read_rows(file, table, is_part, record);
  }
}

}  // namespace vbar::report
