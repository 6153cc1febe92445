#pragma once
// Swarm A on 2022-01-01: its precise orbit and the forces on it, any of which can be left out.

#include <map>
#include <memory>
#include <vector>

#include "host_sim/truth/force_list.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "host_sim/truth/truth_settings.h"
#include "tests/unit/host_sim/truth/swarm/orbit_fit.h"
#include "tests/unit/host_sim/truth/swarm/precise_orbit.h"

namespace vbar::truth::test {

/// Which forces act: by default all that the truth has, with gravity as far as its file goes.
struct SwarmForces {
  ForceModel model = {.drag = true,
                      .geomagnetic_index = GeomagneticIndex::kThreeHourly,
                      .radiation_pressure = true,
                      .shadow = Shadow::kConical,
                      .sun = true,
                      .moon = true,
                      .solid_tides = true,
                      .relativity = true};
  int gravity_degree = 120;
  bool permanent_tide_twice = false;  ///< as if the gravity model's C20 held nothing of it
};

class SwarmOrbit {
 public:
  SwarmOrbit();

  /// The measured positions, ECI, one a minute.
  const Positions& measured() const { return measured_; }
  const fsw::orbit::CartesianState& first_state() const { return first_state_; }

  /// Propagation by the truth's forces and propagator to the instants of the measured positions.
  Positions propagate(const SwarmForces& forces, const OrbitStart& start);

  /// Mean sizes (m/s^2, in x) of the accelerations of all forces along the measured orbit.
  std::vector<ForceAcceleration> mean_sizes(const OrbitStart& start);

 private:
  std::unique_ptr<SpacecraftDynamics> dynamics(const SwarmForces& forces, const OrbitStart& start);
  const ForceData& data(int gravity_degree);

  PreciseOrbit orbit_;
  TruthSettings settings_;
  std::map<int, ForceData> data_;  ///< by degree of gravity
  Positions measured_;
  fsw::orbit::CartesianState first_state_;
};

}  // namespace vbar::truth::test
