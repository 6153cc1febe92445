#pragma once
// The stars of the camera images: ESA's Hipparcos catalogue (SP-1200), by default to V 8.

#include <filesystem>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::twins::camera {

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
