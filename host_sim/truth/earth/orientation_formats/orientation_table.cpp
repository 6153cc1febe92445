#include <array>

#include <erfam.h>

#include "host_sim/truth/earth/daily_table.h"
#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"

namespace vbar::truth {
namespace {

constexpr std::string_view kColumns = "mjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec";

}  // namespace

bool is_orientation_table(std::string_view text) {
  return is_daily_table(text);
}

OrientationDays read_orientation_table(std::string_view text, const std::string& file) {
  OrientationDays days;
  read_daily_table<6>(
      text, file, kColumns, [&](const files::TextLines& lines, int mjd_utc, const std::array<double, 6>& row) {
        days.push_back({mjd_utc, orientation_of(lines, mjd_utc, {row[1], row[2], row[3], row[4], row[5]})});
      });
  return days;
}

}  // namespace vbar::truth
