#pragma once
// Files of one row a day: lines that begin with '#' are comments, the first other line names the columns, the first
// column is the day (MJD, UTC), days follow without gaps.

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"

namespace vbar::truth {

/// Exactly N numbers separated by commas, into `numbers`; false otherwise.
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

/// Calls `take(mjd_utc, numbers)` for each row; it returns what is accepted instead, or nothing if the row
/// is valid. `what` names the file in messages. Throws std::runtime_error naming file, line, what was found and what is
/// accepted.
template <std::size_t N, class Take>
void read_daily_table(const std::filesystem::path& file, std::string_view what, std::string_view columns, Take&& take) {
  // Days of GPS time's century; a file of observations has no others.
  constexpr double kFirstMjd = 44244.0;  // 1980-01-06
  constexpr double kLastMjd = 88068.0;   // 2099-12-31
  files::DataStream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot open the {} file", file.string(), what));
  std::string line;
  bool header_seen = false;
  int before = 0;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto refuse = [&](const std::string& expected) {
      throw std::runtime_error(fmt::format("{}:{}: found \"{}\", expected {}", file.string(), number, line, expected));
    };
    if (line.starts_with('#')) continue;
    if (!header_seen) {
      if (line != columns) refuse(fmt::format("the columns {}", columns));
      header_seen = true;
      continue;
    }
    std::array<double, N> numbers;
    const bool is_row = parse_numbers(line, numbers) && numbers[0] == std::floor(numbers[0]) &&
                        numbers[0] >= kFirstMjd && numbers[0] <= kLastMjd;
    if (!is_row) refuse(fmt::format("a whole MJD from 1980 to 2099 and {} numbers: {}", N - 1, columns));
    const int mjd_utc = static_cast<int>(numbers[0]);
    if (before != 0 && mjd_utc != before + 1) {
      throw std::runtime_error(fmt::format("{}:{}: day {} follows day {}; days must follow without gaps", file.string(),
                                           number, mjd_utc, before));
    }
    if (const std::string accepted = take(mjd_utc, numbers); !accepted.empty()) refuse(accepted);
    before = mjd_utc;
  }
}

}  // namespace vbar::truth
