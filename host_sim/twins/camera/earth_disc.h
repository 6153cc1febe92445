#pragma once
// The Earth in the view of a camera: occultation and radiance. An ellipsoid (WGS 84, its pole along z of GCRF as in
// truth/forces/radiation_pressure.h) without atmosphere or clouds, a Lambert surface of albedo 0.3 in the Sun's light,
// dark at night.

#include "fsw/core/types.h"

namespace vbar::twins::camera {

struct EarthSight {
  double covered = 0.0;        ///< 0 above the limb, 1 below; linear over `blur` about it
  double distance_m = 0.0;     ///< to the surface, or to the limb
  double cosine_of_sun = 0.0;  ///< cosine of the Sun's angle from the local vertical there; negative at night
};

class EarthDisc {
 public:
  /// Makes the disc. `position_eci`: that of the camera, outside the Earth; `sun_eci`: both geocentric, m.
  EarthDisc(const fsw::Vector3& position_eci, const fsw::Vector3& sun_eci);

  /// Returns the sight of the Earth along `direction_eci` (unit); `blur`: rad, positive.
  [[nodiscard]] EarthSight look(const fsw::Vector3& direction_eci, double blur) const;

  /// Whether an object at `distance_m` along `direction_eci` is behind the Earth.
  [[nodiscard]] bool hides(const fsw::Vector3& direction_eci, double distance_m) const;

  /// Half angle of the smallest cone about the centre's direction that holds the whole Earth, rad.
  [[nodiscard]] double angular_radius() const { return angular_radius_; }
  [[nodiscard]] const fsw::Vector3& centre_direction_eci() const { return centre_direction_eci_; }

  /// Returns the photons/(m^2 s sr) of a surface that faces the Sun, for sunlight of the given photons/(m^2 s).
  [[nodiscard]] static double radiance(double sun_photons_per_m2_s);

  /// Returns the light of the Earth at the camera: the sum of all its directions' light, each times its unit vector,
  /// photons/(m^2 s), ECI axes. It points at the Earth's brightest part.
  [[nodiscard]] fsw::Vector3 light_eci(double sun_photons_per_m2_s) const;

 private:
  fsw::Vector3 position_, sun_direction_;  // ECI
  fsw::Vector3 stretched_position_;        // in coordinates in which the Earth is a sphere
  fsw::Vector3 centre_direction_eci_;
  double angular_radius_;
};

// Light of the Earth on a surface near a spacecraft.

/// Returns the irradiance by the Earth of an area whose normal makes an angle of this cosine with the nadir, in units
/// of that of an area which faces it; `sine_earth`: sine of its half angle. A sphere of even radiance, horizon
/// included: Snyder (1996), "Area light sources for real-time graphics", in the form of Lagarde and de Rousiers (2014),
/// "Moving Frostbite to physically based rendering", listing 7.
[[nodiscard]] double earth_light_factor(double cosine, double sine_earth);

}  // namespace vbar::twins::camera
