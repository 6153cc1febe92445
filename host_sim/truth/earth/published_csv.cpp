#include "host_sim/truth/earth/published_csv.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "host_sim/truth/earth/day_sequence.h"

namespace vbar::truth {

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

}  // namespace vbar::truth
