#include "host_sim/truth/earth/published_tables.h"

#include <algorithm>
#include <array>
#include <optional>

#include <erfa.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace vbar::truth {

void DaySequence::take(const files::TextLines& lines, int mjd_utc) {
  if (before_ != 0 && mjd_utc != before_ + 1) {
    throw files::FormatError(fmt::format("{}:{}: day {} follows day {}; days must follow without gaps", lines.file(),
                                         lines.number(), mjd_utc, before_));
  }
  before_ = mjd_utc;
}

int mjd_of_date(const files::TextLines& lines, int year, int month, int day) {
  double zero = 0.0, mjd = 0.0;
  if (year < 1900 || year > 2199 || eraCal2jd(year, month, day, &zero, &mjd) != 0) {
    lines.refuse(fmt::format("the date {}-{:02}-{:02}", year, month, day), "a calendar date from 1900 to 2199");
  }
  return static_cast<int>(mjd);
}

PublishedCsv::PublishedCsv(files::TextLines& lines, char separator) : lines_(lines), separator_(separator) {
  if (!lines_.next()) lines_.refuse("an empty file", "the names of the columns");
  names_ = split();
}

PublishedCsv::Values PublishedCsv::split() const {
  Values values = files::split_at(lines_.line(), separator_);
  std::ranges::transform(values, values.begin(), files::trimmed);
  return values;
}

std::size_t PublishedCsv::place(std::string_view name) const {
  const auto found = std::ranges::find(names_, name);
  if (found == names_.end()) lines_.refuse(fmt::format("a column {}", name));
  return static_cast<std::size_t>(found - names_.begin());
}

std::size_t PublishedCsv::place_before(std::size_t place, std::string_view name) const {
  while (place > 0)
    if (names_[--place] == name) return place;
  lines_.refuse(fmt::format("a column {} before the values that it describes", name));
}

bool PublishedCsv::next() {
  do {
    if (!lines_.next()) return false;
  } while (lines_.is_blank());
  values_ = split();
  if (values_.size() != names_.size())
    lines_.refuse(fmt::format("{} values", values_.size()), fmt::format("one for each of {} columns", names_.size()));
  return true;
}

std::optional<double> PublishedCsv::number_or_blank(std::size_t place) const {
  if (values_[place].empty()) return std::nullopt;
  return number(place);
}

double PublishedCsv::number(std::size_t place) const {
  const auto value = files::number_of(values_[place]);
  if (!value) lines_.refuse(files::quoted(values_[place]), fmt::format("a number as {}", names_[place]));
  if (place + 1 == values_.size()) lines_.check_ended();
  return *value;
}

int PublishedCsv::integer(std::size_t place) const {
  const auto value = files::integer_of(values_[place]);
  if (!value) lines_.refuse(files::quoted(values_[place]), fmt::format("an integer as {}", names_[place]));
  return *value;
}

int PublishedCsv::mjd_of_date(std::size_t place) const {
  const Values parts = files::split_at(values_[place], '-');
  std::array<std::optional<int>, 3> ymd;
  for (std::size_t k = 0; k < ymd.size() && parts.size() == ymd.size(); ++k) ymd[k] = files::integer_of(parts[k]);
  if (!ymd[0] || !ymd[1] || !ymd[2]) lines_.refuse(files::quoted(values_[place]), "a date as 2026-11-25");
  return truth::mjd_of_date(lines_, *ymd[0], *ymd[1], *ymd[2]);
}

bool Sections::take(const files::TextLines& lines) {
  const std::string_view line = files::trimmed(lines.line());
  const bool begins = line.starts_with("BEGIN ");
  if (!begins && !line.starts_with("END ")) return false;
  const auto found = std::ranges::find(names_, line.substr(line.find(' ') + 1));
  if (found == names_.end()) lines.refuse(fmt::format("BEGIN or END of one of {}", fmt::join(names_, ", ")));
  const auto place = static_cast<std::size_t>(found - names_.begin());
  if (begins == open_.has_value() || (!begins && *open_ != place))
    lines.refuse("BEGIN and END of one section after the other");
  open_ = begins ? std::optional(place) : std::nullopt;
  return true;
}

void Sections::check_end(const files::TextLines& lines) const {
  if (open_) lines.refuse("the end of the file", "the END of the section");
}

}  // namespace vbar::truth
