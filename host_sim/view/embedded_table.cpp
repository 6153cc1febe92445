#include "host_sim/view/embedded_table.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <zlib.h>

#include "host_sim/report/plots/png.h"

namespace vbar::view {

namespace {

std::optional<double> number_in(std::string_view cell) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc{} && end == cell.data() + cell.size() && !cell.empty() ? std::optional(value)
                                                                                   : std::nullopt;
}

bool is_of_numbers(const CellColumn& column) {
  return std::ranges::all_of(column.cells, [](const std::string& cell) { return cell.empty() || number_in(cell); });
}

/// Adds the rows from `begin` to before `end` in which the column has its extremes.
void add_extremes(const CellColumn& column, std::size_t begin, std::size_t end, std::set<std::size_t>& rows) {
  std::optional<std::pair<double, std::size_t>> low, high;
  for (std::size_t row = begin; row < end; ++row) {
    const std::optional<double> value = number_in(column.cells[row]);
    if (!value) continue;
    if (!low || *value < low->first) low = {*value, row};
    if (!high || *value > high->first) high = {*value, row};
  }
  if (low) rows.insert({low->second, high->second});
}

std::string joined(const std::vector<std::string>& cells, const std::vector<std::size_t>& rows) {
  std::string text;
  for (const std::size_t row : rows) text.append(cells[row]).append(1, '\n');
  return text;
}

}  // namespace

std::string packed(std::string_view bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::vector<std::uint8_t> compressed(size);
  if (::compress2(compressed.data(), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6) != Z_OK)
    throw std::runtime_error("the data of a page cannot be compressed");
  return report::base64(std::span(compressed).first(size));
}

std::vector<std::size_t> rows_to_keep(const CellTable& table, std::size_t most, const std::set<std::string>& whole) {
  std::set<std::size_t> rows;
  if (table.rows() <= most) {
    for (std::size_t row = 0; row < table.rows(); ++row) rows.insert(row);
    return {rows.begin(), rows.end()};
  }
  std::vector<const CellColumn*> numbers;
  for (const CellColumn& column : table.columns)
    if (is_of_numbers(column)) numbers.push_back(&column);
  const std::size_t parts = std::max<std::size_t>(most / (2 * numbers.size() + 1), 1);
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = part * table.rows() / parts, end = (part + 1) * table.rows() / parts;
    rows.insert(begin);
    for (const CellColumn* const column : numbers) add_extremes(*column, begin, end, rows);
  }
  rows.insert(table.rows() - 1);
  const std::vector<std::string>& keys = table.columns.front().cells;
  for (std::size_t row = 0; row < keys.size(); ++row)
    if (whole.contains(keys[row])) rows.insert(row);
  return {rows.begin(), rows.end()};
}

void TableEmbedder::add(const CellTable& table) {
  const std::vector<std::size_t> rows = rows_to_keep(table, kMaxRows, whole_times_);
  nlohmann::json columns = nlohmann::json::array();
  std::string data;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const CellColumn& column = table.columns[k];
    nlohmann::json head{{"name", column.name}, {"meaning", column.meaning}};
    std::string text = joined(column.cells, rows);
    const auto [place, is_new] = places_.try_emplace(text, Place{tables_.size(), k});
    if (is_new) {
      head["bytes"] = text.size();
      data += text;
    } else {
      head["same"] = {place->second.table, place->second.column};
    }
    columns.push_back(std::move(head));
  }
  tables_.push_back({{"file", table.file},
                     {"rows", rows.size()},
                     {"rows_of_file", table.rows()},
                     {"columns", std::move(columns)},
                     {"data", packed(data)}});
}

}  // namespace vbar::view
