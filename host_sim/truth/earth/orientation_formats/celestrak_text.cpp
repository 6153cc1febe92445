// FORMAT(I4,I3,I3,I6,2F10.6,2F11.7,4F10.6,I4): CelesTrak, "Earth Orientation Parameters Data Documentation".

#include <array>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"
#include "host_sim/truth/earth/sections.h"

namespace vbar::truth {
namespace {

constexpr std::array<std::string_view, 2> kSections{"OBSERVED", "PREDICTED"};

}  // namespace

bool is_celestrak_eop_text(std::string_view text) {
  constexpr std::size_t kLongestHeading = 10000;
  return !text.starts_with("DATATYPE ") &&
         text.substr(0, kLongestHeading).find("\nBEGIN OBSERVED") != std::string_view::npos;
}

OrientationDays read_celestrak_eop_text(std::string_view text, const std::string& file) {
  files::TextLines lines(text, file);
  OrientationDays days;
  DaySequence sequence;
  Sections sections(kSections);
  while (lines.next()) {
    if (lines.is_blank() || lines.line().starts_with('#') || sections.take(lines) || !sections.open()) continue;
    const int date = mjd_of_date(lines, lines.integer_in(1, 4, "a year"), lines.integer_in(5, 7, "a month"),
                                 lines.integer_in(8, 10, "a day"));
    if (const int mjd = lines.integer_in(11, 16, "the MJD"); mjd != date)
      lines.refuse(fmt::format("the MJD {}", mjd), fmt::format("{}, that of the row's date", date));
    sequence.take(lines, date);
    if (date < kFirstDataMjd) continue;
    const PublishedOrientation row{
        lines.number_in(17, 26, "the pole's x in arcsec"), lines.number_in(27, 36, "the pole's y in arcsec"),
        lines.number_in(37, 47, "UT1-UTC in s"), lines.number_or_blank_in(79, 88, "dX in arcsec").value_or(0.0),
        lines.number_or_blank_in(89, 98, "dY in arcsec").value_or(0.0)};
    days.push_back({date, orientation_of(lines, date, row), kSections[*sections.open()] == "PREDICTED"});
  }
  sections.check_end(lines);
  return days;
}

}  // namespace vbar::truth
