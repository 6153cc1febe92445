#pragma once
// Days of a daily series in the order of its file.

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"

namespace vbar::truth {

// Days of GPS time's century; a series of daily values has no others.
inline constexpr int kFirstDataMjd = 44244;  // 1980-01-06
inline constexpr int kLastDataMjd = 88068;   // 2099-12-31

class DaySequence {
 public:
  /// Takes the day of the current line. Throws files::FormatError if it does not follow the one before.
  void take(const files::TextLines& lines, int mjd_utc);

 private:
  int before_ = 0;
};

/// Returns the modified Julian day of a calendar date. Throws files::FormatError for a date that does not exist.
[[nodiscard]] int mjd_of_date(const files::TextLines& lines, int year, int month, int day);

// Files of one row a day: lines that begin with '#' are comments, the first other line names the columns, the first
// column is the day (MJD, UTC), days follow without gaps.

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

// Tables of daily values that services publish as CSV, with the names of their columns in the first line.

/// The columns of the table, and the values of its rows.
class PublishedCsv {
 public:
  using Values = std::vector<std::string_view>;  ///< without blanks about them

  /// Reads the header, then goes to the first line. `lines` must outlive it.
  PublishedCsv(files::TextLines& lines, char separator);

  /// Throws files::FormatError if no column has the name.
  [[nodiscard]] std::size_t place(std::string_view name) const;

  /// Returns the last column of that name before `place`, of tables in which several columns have one name.
  [[nodiscard]] std::size_t place_before(std::size_t place, std::string_view name) const;

  /// Goes to the next row that is not blank; false at the end. Throws files::FormatError for another number of values.
  bool next();

  [[nodiscard]] std::string_view text(std::size_t place) const { return values_[place]; }
  /// Returns the number of a column; nothing for a blank one. Throws files::FormatError for what is not a number.
  [[nodiscard]] std::optional<double> number_or_blank(std::size_t place) const;
  [[nodiscard]] double number(std::size_t place) const;
  [[nodiscard]] int integer(std::size_t place) const;
  /// Returns the modified Julian day of a date as 2026-11-25.
  [[nodiscard]] int mjd_of_date(std::size_t place) const;

 private:
  [[nodiscard]] Values split() const;

  files::TextLines& lines_;
  char separator_;
  Values names_, values_;
};

// Sections of CelesTrak's text files of daily values: lines BEGIN and END with the name of one.

/// Goes along with the lines of a file; at most one section is open.
class Sections {
 public:
  /// Makes a reader; `names` are those that the file may have.
  explicit Sections(std::span<const std::string_view> names) : names_(names) {}

  /// Returns whether the line begins or ends a section. Throws files::FormatError for one within another and unknown
  /// names.
  bool take(const files::TextLines& lines);

  /// Returns the place of the open section among the names.
  [[nodiscard]] std::optional<std::size_t> open() const { return open_; }

  /// Checks, at the end of the file, that no section is open. Throws files::FormatError if a section is open.
  void check_end(const files::TextLines& lines) const;

 private:
  std::span<const std::string_view> names_;
  std::optional<std::size_t> open_;
};

}  // namespace vbar::truth
