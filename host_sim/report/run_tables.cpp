#include "host_sim/report/run_tables.h"

#include <stdexcept>
#include <string>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_columns.h"
#include "host_sim/report/text_file.h"

namespace vbar::report {
namespace {

using Names = std::vector<std::string>;

template <class Row>
Names column_names() {
  Names names;
  const Row row;
  const auto collect = [&](const ColumnName& name, const auto&) { names.push_back(name.text()); };
  visit_columns(row, collect);
  return names;
}

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line, const std::string& what) {
  throw std::runtime_error(fmt::format("{}:{}: {}", file.string(), line, what));
}

void check_head(const std::filesystem::path& file, const Names& expected, const Names& found) {
  for (std::size_t k = 0; k < expected.size(); ++k) {
    if (k >= found.size()) fail(file, 1, fmt::format("column \"{}\" is missing", expected[k]));
    if (found[k] != expected[k]) {
      fail(file, 1, fmt::format("column {} is \"{}\", expected \"{}\"", k + 1, found[k], expected[k]));
    }
  }
  if (found.size() > expected.size()) fail(file, 1, fmt::format("column \"{}\" is unknown", found[expected.size()]));
}

/// Takes the cells of a line one after the other.
struct CellReader {
  const std::filesystem::path& file;
  std::size_t line;
  const Names& cells;
  std::size_t next = 0;

  template <class Value>
  void operator()(const ColumnName& name, Value& value) {
    const std::string& cell = cells[next++];
    if (!read_value(cell, value)) {
      fail(file, line, fmt::format("{} is \"{}\", which is no value of that column", name.text(), cell));
    }
  }
};

}  // namespace

template <class Row>
void write_rows(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::string text = fmt::format("{}\n", fmt::join(column_names<Row>(), ","));
  for (const Row& row : rows) {
    bool first = true;
    const auto append = [&](const ColumnName&, const auto& value) {
      if (!first) text += ',';
      first = false;
      append_value(text, value);
    };
    visit_columns(row, append);
    text += '\n';
  }
  replace_text_file(file, text);
}

template <class Row>
std::vector<Row> read_rows(const std::filesystem::path& file) {
  const Names lines = read_lines(file);
  const Names expected = column_names<Row>();
  Names cells;
  if (lines.empty()) fail(file, 1, "the file is empty: not even column names");
  if (!split_cells(lines.front(), cells)) fail(file, 1, "a quote is not closed");
  check_head(file, expected, cells);

  std::vector<Row> rows;
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const std::size_t line = k + 1;
    if (!split_cells(lines[k], cells)) fail(file, line, "a quote is not closed");
    if (cells.size() != expected.size()) {
      fail(file, line, fmt::format("{} cells, expected {}", cells.size(), expected.size()));
    }
    CellReader reader{file, line, cells};
    visit_columns(rows.emplace_back(), reader);
  }
  return rows;
}

template void write_rows(const std::filesystem::path&, const std::vector<TruthRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<AttitudeRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<EstimateRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<GnssRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<ImageRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<ObjectRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<PoseRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<KeypointRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<GalleryImage>&);
template void write_rows(const std::filesystem::path&, const std::vector<ManeuverRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<ResidualRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<NoteRow>&);
template void write_rows(const std::filesystem::path&, const std::vector<WaypointRow>&);

template std::vector<TruthRow> read_rows(const std::filesystem::path&);
template std::vector<AttitudeRow> read_rows(const std::filesystem::path&);
template std::vector<EstimateRow> read_rows(const std::filesystem::path&);
template std::vector<GnssRow> read_rows(const std::filesystem::path&);
template std::vector<ImageRow> read_rows(const std::filesystem::path&);
template std::vector<ObjectRow> read_rows(const std::filesystem::path&);
template std::vector<PoseRow> read_rows(const std::filesystem::path&);
template std::vector<KeypointRow> read_rows(const std::filesystem::path&);
template std::vector<GalleryImage> read_rows(const std::filesystem::path&);
template std::vector<ManeuverRow> read_rows(const std::filesystem::path&);
template std::vector<ResidualRow> read_rows(const std::filesystem::path&);
template std::vector<NoteRow> read_rows(const std::filesystem::path&);
template std::vector<WaypointRow> read_rows(const std::filesystem::path&);

}  // namespace vbar::report
