#pragma once
// Tables of daily values that services publish as CSV, with the names of their columns in the first line.

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "host_sim/files/text_lines.h"

namespace vbar::truth {

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

}  // namespace vbar::truth
