#pragma once
// Files of stars: the project's own table (data/stars), and the main catalogue of Hipparcos as published.

#include <cmath>
#include <filesystem>
#include <vector>

namespace vbar::twins::camera {

inline constexpr double kRadPerDegree = M_PI / 180.0;
inline constexpr double kRadPerMilliarcsecond = kRadPerDegree / 3.6e6;

struct CatalogueStar {
  int hip = 0;              ///< 0: not in the Hipparcos catalogue
  double ra_deg = 0.0;      ///< ICRS, barycentric, at J2000.0
  double dec_deg = 0.0;     ///< ICRS, barycentric, at J2000.0
  double pm_ra_mas = 0.0;   ///< mas a Julian year, multiplied by the cosine of the declination
  double pm_dec_mas = 0.0;  ///< mas a Julian year
  double v = 0.0;           ///< Johnson V
  double b_v = 0.0;         ///< Johnson B-V
};

/// Stars in the order of the file, whose format is recognised by its first row:
/// - hip_main.dat of ESA SP-1200 (CDS I/239): 78 fields separated by "|". Entries without an astrometric solution or a
/// V
///   magnitude are left out; without a colour B-V is 0.6, that of a star like the Sun. Positions are moved from
///   J1991.25, the epoch of the catalogue, to J2000.0 along a great circle.
/// - otherwise the columns of data/stars/hipparcos_v8.csv, brightest first.
/// Throws std::runtime_error that names file and line, also for a file that is cut short: one that ends within a row,
/// or that lacks stars to V 8.
[[nodiscard]] std::vector<CatalogueStar> read_star_catalogue(const std::filesystem::path& file);

}  // namespace vbar::twins::camera
