#pragma once
// Fraction of the Sun that is visible past the Earth, and where it changes.
//
// The Earth's figure is an ellipsoid of revolution about the z axis of GCRF (the true pole is 1e-3 rad away in 2011,
// which moves the limb by 25 m). Stretching z by 1/(1 - flattening) makes it a sphere and keeps straight lines
// straight, so the shadow of the ellipsoid is that of the sphere in stretched coordinates (Escobal 1965, chapter 5,
// uses the same device for visibility). That is exact for light that arrives parallel; of the Sun's disk it stretches
// the height by up to 0.3 per cent, and the penumbra's width with it. No atmosphere: its refraction and absorption
// soften and shift real edges by some seconds in a low orbit.

#include "fsw/core/types.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/force_model.h"

namespace vbar::truth {

inline constexpr double kSunRadius = 6.957e8;  ///< m, nominal (IAU 2015 B3)

struct EarthFigure {
  double equatorial_radius = 6378137.0;     ///< m; WGS 84
  double flattening = 1.0 / 298.257223563;  ///< WGS 84; 0 is a sphere
};

/// Returns the edge function of the shadow in sunlight that arrives parallel: positive in the light, zero at the edge
/// of the Earth's shadow, negative in it, in metres along the direction to the Sun, and smooth. `position` (outside the
/// Earth) and `sun`: geocentric, m, axes of GCRF.
double cylindrical_shadow_edge(const fsw::Vector3& position, const fsw::Vector3& sun, const EarthFigure& earth);

/// The Sun and the Earth as disks in the spacecraft's sky, rad.
struct SkyDisks {
  double sun_radius = 0.0;
  double earth_radius = 0.0;
  double separation = 0.0;  ///< separation of their centres
};

SkyDisks sky_disks(const fsw::Vector3& position, const fsw::Vector3& sun, const EarthFigure& earth);

/// Returns an angle that is positive where the Sun is clear of the Earth, zero at the penumbra's outer rim; rad.
inline double penumbra_outer_edge(const SkyDisks& disks) {
  return disks.separation - (disks.earth_radius + disks.sun_radius);
}

/// Returns zero at the penumbra's inner rim and a negative value inside: in the umbra near the Earth, where the Sun is
/// hidden, and beyond its apex (1.4 million km) in the antumbra, where the Earth is wholly before the Sun; rad.
double penumbra_inner_edge(const SkyDisks& disks);

/// Returns the uncovered part of the Sun's disk where the rims of the disks cross, 0 to 1: the overlap of two circles
/// on the sky, exact (in the stereographic projection about the Sun's centre both stay circles; its scale varies by
/// 2e-5 over the Sun's disk). Outside of that the value at the rim crossed. The Sun's limb is taken as bright as its
/// centre.
double penumbra_sunlit_fraction(const SkyDisks& disks);

/// Returns the sunlit fraction inside the inner rim: 0 in the umbra, 1 less the ratio of the disks' areas in the
/// antumbra.
double inner_sunlit_fraction(const SkyDisks& disks);

// Pressure of sunlight on a sphere (cannonball), with the Earth's shadow (Montenbruck and Gill 2000, section 3.4).

inline constexpr double kSolarIrradiance = 1361.0;    ///< W/m^2 at 1 au, nominal (IAU 2015 B3; Kopp and Lean 2011)
inline constexpr double kSpeedOfLight = 299792458.0;  ///< m/s
/// Pressure of full sunlight on a black surface across it at 1 au: 4.54e-6 N/m^2.
inline constexpr double kSolarPressure = kSolarIrradiance / kSpeedOfLight;

/// Acceleration away from the Sun: (1 au / distance)^2 * kSolarPressure * C_R A / m * sunlit fraction.
///
/// Its edges are the cylinder's one, or the outer rim (0) and inner rim (1) of the cone's penumbra; none without a
/// shadow.
///
/// In the penumbra the light varies with the power 3/2 of the distance from the rim, where a method of order 5 loses
/// its order: there its steps are no longer than it takes to orbit through an eighth of the Sun's diameter (1.1 s in a
/// low orbit), which leaves as little error as the cylinder's sharp edge.
class RadiationPressureForce final : public Force {
 public:
  /// Throws std::invalid_argument unless the mass is above 0 and area and coefficient are not below.
  RadiationPressureForce(const SurfaceProperties& surface, Shadow shadow, const EarthFigure& earth = {});

  std::string_view name() const override { return "radiation_pressure"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;
  bool needs_sun_and_moon() const override { return true; }
  int edge_count() const override;
  double edge(int index, const ForceInput& input) const override;
  void set_side(int index, bool positive) override { positive_[index] = positive; }

  double longest_step(const ForceInput& input) const override;

  /// Returns the part of the Sun's light that arrives, 0 to 1, on the side of the edges that was set.
  double sunlit_fraction(const ForceInput& input) const;

 private:
  double scale_;  ///< acceleration times squared distance in full sunlight, m^3/s^2
  Shadow shadow_;
  EarthFigure earth_;
  bool positive_[2] = {true, true};
};

}  // namespace vbar::truth
