#pragma once
// The formats of Earth orientation that are read as published. Each is recognised by its contents, whatever the name of
// the file; each has its functions here and its line in the list.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/earth_orientation.h"

namespace vbar::truth {

using OrientationDays = std::vector<EarthOrientationSeries::Day>;

struct OrientationFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  /// Throws files::FormatError. Days before GPS time (1980-01-06) are checked and left out.
  OrientationDays (*read)(std::string_view text, const std::string& file);
};

// Table of this project: "mjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec".
[[nodiscard]] bool is_orientation_table(std::string_view text);
[[nodiscard]] OrientationDays read_orientation_table(std::string_view text, const std::string& file);

// finals2000A.all, .data and .daily: IERS Rapid Service and Prediction Centre (USNO), readme.finals2000A. The values of
// Bulletin A, which every row has; flags I (observed) and P (predicted). The file ends for this program where rows
// begin that have a date only. Offsets of the pole that a row lacks, as late predictions do, are 0: an error below 1
// mas.
[[nodiscard]] bool is_finals2000a(std::string_view text);
[[nodiscard]] OrientationDays read_finals2000a(std::string_view text, const std::string& file);

// EOP C04 of Paris Observatory, IAU 2000, at 0h UTC: the columns of series 14 (and 08), and those of series 20.
[[nodiscard]] bool is_eop_c04(std::string_view text);
[[nodiscard]] OrientationDays read_eop_c04(std::string_view text, const std::string& file);

// finals2000A and EOP C04 as the IERS data centre gives them as CSV: one set of column names, the types "final" and
// "prediction" in finals2000A alone. Offsets of the nutation of IAU 1980 are rejected.
[[nodiscard]] bool is_iers_csv(std::string_view text);
[[nodiscard]] OrientationDays read_iers_csv(std::string_view text, const std::string& file);

// EOP-All, EOP-Last5Years of CelesTrak: C04 and predictions, as text in fixed columns and as CSV.
[[nodiscard]] bool is_celestrak_eop_text(std::string_view text);
[[nodiscard]] OrientationDays read_celestrak_eop_text(std::string_view text, const std::string& file);
[[nodiscard]] bool is_celestrak_eop_csv(std::string_view text);
[[nodiscard]] OrientationDays read_celestrak_eop_csv(std::string_view text, const std::string& file);

[[nodiscard]] std::span<const OrientationFormat> orientation_formats();

/// Reads the days of a text in any of the formats. Throws files::FormatError; for an unknown format it names all.
[[nodiscard]] OrientationDays read_orientation(std::string_view text, const std::string& file);

/// Values of one row in the units of the publications. orientation_of() rejects values that no Earth orientation since
/// 1962 has been near, as other units or another nutation model give.
struct PublishedOrientation {
  double x_arcsec = 0.0, y_arcsec = 0.0, ut1_minus_utc_s = 0.0, dx_arcsec = 0.0, dy_arcsec = 0.0;
};
[[nodiscard]] EarthOrientation orientation_of(const files::TextLines& lines, int mjd_utc,
                                              const PublishedOrientation& row);

}  // namespace vbar::truth
