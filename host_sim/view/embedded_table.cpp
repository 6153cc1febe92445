#include "host_sim/view/embedded_table.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <zlib.h>

#include "host_sim/report/plots/png.h"

namespace vbar::view {

namespace {

/// Level of zlib by which forms of a column are compared.
constexpr int kTrialLevel = 1;

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

std::string compressed(std::string_view bytes, int level) {
  uLongf size = ::compressBound(bytes.size());
  std::string result(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                  bytes.size(), level) != Z_OK)
    throw std::runtime_error("the data of a page cannot be compressed");
  result.resize(size);
  return result;
}

/// Returns the bits of each cell as binary64, an empty cell that of NaN; nothing if a cell is a word or not a finite
/// number, or an integer that binary64 does not hold.
std::optional<Bits> bits_of(const std::vector<std::string>& cells, const std::vector<std::size_t>& rows) {
  constexpr std::size_t kDigitsOfBinary64 = 15;
  Bits bits;
  bits.reserve(rows.size());
  for (const std::size_t row : rows) {
    const std::string& cell = cells[row];
    const double value = cell.empty() ? std::numeric_limits<double>::quiet_NaN() : number_in(cell).value_or(NAN);
    const bool is_long_integer = cell.size() > kDigitsOfBinary64 && cell.find_first_of(".e") == std::string::npos;
    if (!cell.empty() && (!std::isfinite(value) || is_long_integer)) return std::nullopt;
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  }
  return bits;
}

/// Returns all lowest bytes of the numbers, then all second ones, and so on: neighbours resemble each other in the
/// upper bytes.
std::string planes_of(const Bits& numbers) {
  std::string bytes;
  bytes.reserve(8 * numbers.size());
  for (unsigned shift = 0; shift < 64; shift += 8)
    for (const std::uint64_t number : numbers) bytes.push_back(static_cast<char>(number >> shift & 0xff));
  return bytes;
}

/// Returns a difference modulo 2^64 with its sign in the lowest bit, so that small ones of either sign have zeros
/// above.
std::uint64_t folded(std::uint64_t difference) {
  return difference << 1 ^ (difference >> 63 != 0 ? ~std::uint64_t{0} : 0);
}

/// Returns the folded differences between the bits of each row and of the row before it.
Bits steps_of(const Bits& bits) {
  Bits steps;
  for (std::uint64_t before = 0; const std::uint64_t number : bits) {
    steps.push_back(folded(number - before));
    before = number;
  }
  return steps;
}

Bits differences_of(const Bits& bits, const Bits& reference) {
  Bits differences;
  for (std::size_t row = 0; row < bits.size(); ++row) differences.push_back(folded(bits[row] - reference[row]));
  return differences;
}

}  // namespace

std::string packed(std::string_view bytes) {
  const std::string result = compressed(bytes, 6);
  return report::base64(std::span(reinterpret_cast<const std::uint8_t*>(result.data()), result.size()));
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

nlohmann::json TablesInPage::add(const std::vector<std::string>& cells, const std::vector<std::size_t>& rows,
                                 const std::string& name, Place place, std::string& data) {
  const std::string text = joined(cells, rows);
  const auto [first, is_new] = places_.try_emplace(text, place);
  if (!is_new) return {{"same", {first->second.table, first->second.column}}};
  nlohmann::json head{{"form", "text"}};
  std::string chosen = text;
  if (std::optional<Bits> bits = bits_of(cells, rows)) {
    std::size_t least = compressed(text, kTrialLevel).size();
    const auto offer = [&](const Bits& numbers, nlohmann::json form) {
      std::string bytes = planes_of(numbers);
      const std::size_t size = compressed(bytes, kTrialLevel).size();
      if (size >= least) return;
      least = size;
      chosen = std::move(bytes);
      head = std::move(form);
    };
    offer(*bits, {{"form", "number"}});
    offer(steps_of(*bits), {{"form", "step"}});
    Named& known = named_[name];
    if (known.bits.size() == bits->size())
      offer(differences_of(*bits, known.bits),
            {{"form", "difference"}, {"of", {known.place.table, known.place.column}}});
    known = {place, std::move(*bits)};
  }
  head["bytes"] = chosen.size();
  data += chosen;
  return head;
}

void TablesInPage::add(const CellTable& table, const std::vector<std::size_t>& rows) {
  nlohmann::json columns = nlohmann::json::array();
  std::string data;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const CellColumn& column = table.columns[k];
    columns.push_back(add(column.cells, rows, column.name, {tables_.size(), k}, data));
    columns.back().update({{"name", column.name}, {"meaning", column.meaning}});
  }
  std::string text = packed(data);
  size_ += text.size();
  tables_.push_back({{"file", table.file},
                     {"name", table.name},
                     {"rows", rows.size()},
                     {"rows_of_file", std::max(table.rows(), table.rows_of_file)},
                     {"columns", std::move(columns)},
                     {"data", std::move(text)}});
}

nlohmann::json embedded(std::span<const CellTable> tables, std::size_t most_bytes, const std::set<std::string>& whole) {
  constexpr std::size_t kFewestRows = 100;
  for (std::size_t most_rows = kMaxRows;; most_rows /= 2) {
    TablesInPage page;
    for (const CellTable& table : tables) page.add(table, rows_to_keep(table, most_rows, whole));
    if (page.size() <= most_bytes || most_rows < kFewestRows) return page.take();
  }
}

}  // namespace vbar::view
