#pragma once
// General relativity's corrections to a satellite's motion (IERS Conventions 2010, eq. 10.12, with the parameters beta
// = gamma = 1 of Einstein's theory). In a low orbit:
//   Schwarzschild   the Earth's mass curves space and time     2e-8 m/s^2
//   Lense-Thirring  the Earth's rotation drags space along     2e-10 m/s^2
//   de Sitter       the Earth's fall around the Sun turns it   4e-11 m/s^2

#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

class RelativityForce final : public Force {
 public:
  /// Makes the force; `gm` is the Earth's, m^3/s^2.
  explicit RelativityForce(double gm) : gm_(gm) {}

  std::string_view name() const override { return "relativity"; }
  bool needs_sun_and_moon() const override { return true; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  double gm_;
};

/// Return the three parts, m/s^2 in ECI, at a position (m) and velocity (m/s) in ECI.
fsw::Vector3 schwarzschild_acceleration(double gm, const fsw::Vector3& position_eci, const fsw::Vector3& velocity_eci);

/// `spin_axis_eci` is the unit vector to the Earth's north pole.
fsw::Vector3 lense_thirring_acceleration(double gm, const fsw::Vector3& spin_axis_eci, const fsw::Vector3& position_eci,
                                         const fsw::Vector3& velocity_eci);

/// `sun_distance` is that from the Earth, m.
fsw::Vector3 de_sitter_acceleration(double sun_distance, const fsw::Vector3& velocity_eci);

}  // namespace vbar::truth
