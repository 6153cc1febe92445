#include "host_sim/twins/camera/star_sky.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/aberration.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/star_catalogue.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

SkyStar sky_star_of(const CatalogueStar& entry, double zero_magnitude_photons) {
  const double ra = entry.ra_deg * kRadPerDegree, dec = entry.dec_deg * kRadPerDegree;
  SkyStar star;
  star.hip = entry.hip;
  star.direction_j2000 = Vector3(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
  const Vector3 east(-std::sin(ra), std::cos(ra), 0.0);
  const Vector3 north = star.direction_j2000.cross(east);
  star.motion_per_year = kRadPerMilliarcsecond * (entry.pm_ra_mas * east + entry.pm_dec_mas * north);
  star.v = entry.v;
  star.b_v = entry.b_v;
  star.photons_per_m2_s = star_photons(zero_magnitude_photons, star.v, star.b_v);
  return star;
}

}  // namespace

StarSky StarSky::load(const std::filesystem::path& file, double zero_magnitude_photons) {
  StarSky sky;
  for (const CatalogueStar& entry : read_star_catalogue(file))
    sky.stars_.push_back(sky_star_of(entry, zero_magnitude_photons));
  std::stable_sort(sky.stars_.begin(), sky.stars_.end(),
                   [](const SkyStar& a, const SkyStar& b) { return a.direction_j2000.z() < b.direction_j2000.z(); });
  return sky;
}

void StarSky::find(const Vector3& axis_eci, double half_angle, double years_since_j2000, const Vector3& velocity_bcrs,
                   std::vector<ApparentStar>& seen) const {
  // The catalogue's place and the apparent one differ by less: 26 arcsec of aberration, 10 arcsec a year of the
  // fastest.
  const double reach = half_angle + 0.001 + 5e-5 * std::abs(years_since_j2000);
  const double declination = std::asin(std::clamp(axis_eci.z(), -1.0, 1.0));
  const auto z_of = [](double angle) { return std::sin(std::clamp(angle, -M_PI / 2.0, M_PI / 2.0)); };
  const auto from = std::lower_bound(stars_.begin(), stars_.end(), z_of(declination - reach),
                                     [](const SkyStar& star, double z) { return star.direction_j2000.z() < z; });
  const double z_to = z_of(declination + reach);
  const double cosine = std::cos(std::min(reach, M_PI));
  for (auto star = from; star != stars_.end() && star->direction_j2000.z() <= z_to; ++star) {
    if (star->direction_j2000.dot(axis_eci) < cosine) continue;
    const Vector3 now = (star->direction_j2000 + years_since_j2000 * star->motion_per_year).normalized();
    seen.push_back({&*star, apparent_direction(now, velocity_bcrs)});
  }
}

}  // namespace vbar::twins::camera
