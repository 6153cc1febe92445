#pragma once
// Files of one row a day: lines that begin with '#' are comments, the first other line names the columns, the first
// column is the day (MJD, UTC), days follow without gaps.

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/day_sequence.h"

namespace vbar::truth {

/// Parses exactly N numbers separated by commas into `numbers`; false for any other text.
template <std::size_t N>
bool parse_numbers(std::string_view line, std::array<double, N>& numbers) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t column = 0; column < N; ++column) {
    const auto [next, error] = std::from_chars(at, end, numbers[column]);
    if (error != std::errc{} || !std::isfinite(numbers[column])) return false;
    at = next;
    if (column + 1 < N && (at == end || *at++ != ',')) return false;
  }
  return at == end;
}

/// Returns whether the first line that is not a comment begins with "mjd_utc,".
inline bool is_daily_table(std::string_view text) {
  files::TextLines lines(text, "");
  while (lines.next())
    if (!lines.line().starts_with('#')) return lines.line().starts_with("mjd_utc,");
  return false;
}

/// Calls `take(lines, mjd_utc, numbers)` for each row; it throws for a row that is not valid. Throws
/// files::FormatError naming file, line, what was found and what is accepted.
template <std::size_t N, class Take>
void read_daily_table(std::string_view text, const std::string& file, std::string_view columns, Take&& take) {
  files::TextLines lines(text, file);
  DaySequence sequence;
  bool header_seen = false;
  while (lines.next()) {
    if (lines.line().starts_with('#')) continue;
    if (!header_seen) {
      if (lines.line() != columns) lines.refuse(fmt::format("the columns {}", columns));
      header_seen = true;
      continue;
    }
    std::array<double, N> numbers;
    const bool is_row = parse_numbers(lines.line(), numbers) && numbers[0] == std::floor(numbers[0]) &&
                        numbers[0] >= kFirstDataMjd && numbers[0] <= kLastDataMjd;
    if (!is_row) lines.refuse(fmt::format("a whole MJD from 1980 to 2099 and {} numbers: {}", N - 1, columns));
    lines.check_ended();
    const int mjd_utc = static_cast<int>(numbers[0]);
    sequence.take(lines, mjd_utc);
    take(lines, mjd_utc, numbers);
  }
}

}  // namespace vbar::truth
