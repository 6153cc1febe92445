#pragma once
// Swarm A on 2022-01-01: its precise orbit and the forces on it, any of which can be left out.

#include <memory>
#include <vector>

#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/space_weather.h"
#include "host_sim/truth/forces/force_model.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/gravity_field.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "tests/unit/host_sim/truth/swarm/orbit_fit.h"
#include "tests/unit/host_sim/truth/swarm/precise_orbit.h"

namespace vbar::truth::test {

/// Forces beside gravity, and gravity's degree.
struct SwarmForces {
  int gravity_degree = 120;
  bool drag = true;
  bool radiation_pressure = true;
  bool sun = true;
  bool moon = true;
  bool solid_tides = true;
  bool relativity = true;
  bool permanent_tide_twice = false;  ///< as if the gravity model's C20 held nothing of it
};

class SwarmOrbit {
 public:
  SwarmOrbit();

  /// The measured positions, ECI, one a minute.
  const Positions& measured() const { return measured_; }
  const fsw::orbit::CartesianState& first_state() const { return first_state_; }

  /// Propagation by the project's propagator to the instants of the measured positions.
  Positions propagate(const SwarmForces& forces, const OrbitStart& start) const;

  /// Mean sizes (m/s^2) of the forces' accelerations along the measured orbit.
  std::vector<ForceAcceleration> mean_sizes(const OrbitStart& start) const;

 private:
  std::unique_ptr<SpacecraftDynamics> dynamics(const SwarmForces& forces, double drag_scale) const;

  PreciseOrbit orbit_;
  std::shared_ptr<const EarthOrientationSeries> orientation_;
  std::shared_ptr<const SpaceWeather> space_weather_;
  std::shared_ptr<const Nrlmsise00Tables> atmosphere_;
  GravityCoefficients gravity_;
  Positions measured_;
  fsw::orbit::CartesianState first_state_;
};

}  // namespace vbar::truth::test
