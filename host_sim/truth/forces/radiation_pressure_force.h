#pragma once
// Pressure of sunlight on a sphere (cannonball), with the Earth's shadow (Montenbruck and Gill 2000, section 3.4).

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/force_model.h"
#include "host_sim/truth/forces/shadow.h"
#include "host_sim/truth/forces/surface_properties.h"

namespace vbar::truth {

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
