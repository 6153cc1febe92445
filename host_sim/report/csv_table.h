#pragma once
// Cells of a CSV file (RFC 4180, without line breaks inside a cell) and their values.
//
// Numbers are written in the shortest form that reads back as the same bits. A number that is not finite is no value:
// an empty cell, as is an absent one.

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <vbar/fields.h>

namespace vbar::report {

/// A number that is written as a word, or, of bits, as words joined by plus signs.
template <class Number>
struct Coded {
  Number& value;
  Codes codes;
};

/// The word of a code; the number itself if it has none.
[[nodiscard]] std::string word_of(const Codes& codes, int value);

/// The code of a word or a number; nothing if it is neither.
[[nodiscard]] std::optional<int> code_of(const Codes& codes, std::string_view word);

/// Appends one cell's text, quoted where it must be. A line break becomes a space.
void append_text(std::string& line, std::string_view text);

/// The cells of a line. False if a quote is never closed or stands inside an unquoted cell.
[[nodiscard]] bool split_cells(std::string_view line, std::vector<std::string>& cells);

/// The lines of a file, without their ends. Throws std::runtime_error that names the file.
[[nodiscard]] std::vector<std::string> read_lines(const std::filesystem::path& file);

template <class Value>
void append_value(std::string& line, const Value& value) {
  if constexpr (requires { value.codes; }) {
    append_text(line, word_of(value.codes, static_cast<int>(value.value)));
  } else if constexpr (std::is_same_v<Value, std::string>) {
    append_text(line, value);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    if (value) append_value(line, *value);
  } else if constexpr (std::is_floating_point_v<Value>) {
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(line), "{}", value);
  } else if constexpr (std::is_same_v<Value, bool>) {
    line += value ? '1' : '0';
  } else {
    fmt::format_to(std::back_inserter(line), "{}", value);
  }
}

/// False if the cell holds no such value. An empty cell leaves a code as it is: it is not known.
template <class Value>
[[nodiscard]] bool read_value(std::string_view cell, Value& value) {
  if constexpr (requires { value.codes; }) {
    const std::optional<int> code = code_of(value.codes, cell);
    if (code) value.value = static_cast<std::remove_reference_t<decltype(value.value)>>(*code);
    return cell.empty() || (code && value.value == *code);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    value = cell;
    return true;
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    value.reset();
    return cell.empty() || read_value(cell, value.emplace());
  } else if constexpr (std::is_same_v<Value, bool>) {
    value = cell == "1";
    return value || cell == "0";
  } else {
    if constexpr (std::is_floating_point_v<Value>) {
      if (cell.empty()) {
        value = std::numeric_limits<Value>::quiet_NaN();
        return true;
      }
    }
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc{} || end != cell.data() + cell.size()) return false;
    if constexpr (std::is_floating_point_v<Value>) return std::isfinite(value);
    return true;
  }
}

}  // namespace vbar::report
