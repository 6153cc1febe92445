#pragma once
// Apparent direction, for a moving observer, of light that comes from `direction`.

#include <cmath>
#include <filesystem>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::twins::camera {

inline constexpr double kLightSpeed = 299792458.0;  ///< m/s

/// Returns the apparent direction as a unit vector; `direction` unit, `velocity` of the observer in the same axes, m/s,
/// below that of light. Special relativity (Klioner 2003, equation 10); the Sun's field would add 0.4 milliarcsecond.
inline fsw::Vector3 apparent_direction(const fsw::Vector3& direction, const fsw::Vector3& velocity) {
  const fsw::Vector3 beta = velocity / kLightSpeed;
  const double inverse_gamma = std::sqrt(1.0 - beta.squaredNorm());
  const double along = direction.dot(beta);
  const fsw::Vector3 seen = inverse_gamma * direction + (1.0 + along / (1.0 + inverse_gamma)) * beta;
  return seen.normalized();
}

// Files of stars: the project's own table (data/stars), and the main catalogue of Hipparcos as published.

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

// The stars of the camera images: ESA's Hipparcos catalogue (SP-1200), by default to V 8.

struct SkyStar {
  int hip = 0;                                           ///< 0: not in the Hipparcos catalogue
  fsw::Vector3 direction_j2000 = fsw::Vector3::UnitX();  ///< ICRS, barycentric, at J2000.0; unit
  fsw::Vector3 motion_per_year = fsw::Vector3::Zero();   ///< motion of the direction, rad a Julian year
  double v = 0.0;                                        ///< magnitude
  double b_v = 0.0;                                      ///< colour
  double photons_per_m2_s = 0.0;
};

struct ApparentStar {
  const SkyStar* star = nullptr;
  fsw::Vector3 direction_eci = fsw::Vector3::UnitX();  ///< apparent, GCRF axes, unit
};

class StarSky {
 public:
  /// Loads the stars of a file that read_star_catalogue accepts; errors as there.
  static StarSky load(const std::filesystem::path& file, double zero_magnitude_photons);

  /// Appends the stars within `half_angle` (rad) of `axis_eci` (unit), and some a little outside, to `seen`.
  /// `velocity_bcrs` of the observer: m/s, barycentric. Proper motion is uniform and straight in the plane that touches
  /// the sphere at J2000 (Hipparcos, volume 1, 1.2.8, without parallax: 0.7 arcsec for the nearest star, a tenth of a
  /// pixel in a thousand for almost all).
  void find(const fsw::Vector3& axis_eci, double half_angle, double years_since_j2000,
            const fsw::Vector3& velocity_bcrs, std::vector<ApparentStar>& seen) const;

  [[nodiscard]] const std::vector<SkyStar>& stars() const { return stars_; }  ///< from south to north

 private:
  std::vector<SkyStar> stars_;
};

}  // namespace vbar::twins::camera
