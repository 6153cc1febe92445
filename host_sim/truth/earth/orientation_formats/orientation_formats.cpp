#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <erfam.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

std::span<const OrientationFormat> orientation_formats() {
  static constexpr std::array kFormats{
      OrientationFormat{"IERS finals2000A", is_finals2000a, read_finals2000a},
      OrientationFormat{"CelesTrak EOP-All (text)", is_celestrak_eop_text, read_celestrak_eop_text},  // names C04 too
      OrientationFormat{"IERS EOP C04 (series 14 or 20)", is_eop_c04, read_eop_c04},
      OrientationFormat{"IERS finals2000A or C04 as CSV", is_iers_csv, read_iers_csv},
      OrientationFormat{"CelesTrak EOP-All (CSV)", is_celestrak_eop_csv, read_celestrak_eop_csv},
      OrientationFormat{"the table of data/earth", is_orientation_table, read_orientation_table},
  };
  return kFormats;
}

OrientationDays read_orientation(std::string_view text, const std::string& file) {
  const auto formats = orientation_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const OrientationFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("Earth orientation in one of the formats {}", fmt::join(names, ", ")));
}

EarthOrientation orientation_of(const files::TextLines& lines, int mjd_utc, const PublishedOrientation& row) {
  // Since 1962: the pole within 0.6 arcsec, UT1-UTC within 0.9 s by definition, IAU 2000A nutation within 1.5 mas
  // (that of IAU 1980 is off by 50 to 150 mas).
  constexpr double kPole_arcsec = 1.0, kUt1_s = 1.0, kOffset_arcsec = 0.01;
  const auto check = [&](double value, double limit, std::string_view what, std::string_view unit) {
    if (!(std::abs(value) <= limit))
      lines.refuse(fmt::format("{} of {} {}", what, value, unit), fmt::format("up to {} {}", limit, unit));
  };
  check(row.x_arcsec, kPole_arcsec, "a pole x", "arcsec");
  check(row.y_arcsec, kPole_arcsec, "a pole y", "arcsec");
  check(row.ut1_minus_utc_s, kUt1_s, "a UT1-UTC", "s");
  check(row.dx_arcsec, kOffset_arcsec, "a dX (IAU 2000A)", "arcsec");
  check(row.dy_arcsec, kOffset_arcsec, "a dY (IAU 2000A)", "arcsec");
  return {row.ut1_minus_utc_s - tai_minus_utc_s(mjd_utc), row.x_arcsec * ERFA_DAS2R, row.y_arcsec * ERFA_DAS2R,
          row.dx_arcsec * ERFA_DAS2R, row.dy_arcsec * ERFA_DAS2R};
}

}  // namespace vbar::truth
