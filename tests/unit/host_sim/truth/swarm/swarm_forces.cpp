#include "tests/unit/host_sim/truth/swarm/swarm_forces.h"

#include <cstddef>
#include <utility>

#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth::test {
namespace {

// A Swarm satellite (ESA's mission data): 473 kg at launch in 2013 with 105 kg of propellant, of which a part is spent.
// A slender body of 5 m with a boom of 4 m along the flight direction: about 1 m^2 across it, several times as much
// seen from the side or above. Drag is scaled by the fit.
constexpr SurfaceProperties kSwarm{
    .mass_kg = 420.0,
    .drag_area_m2 = 1.0,
    .drag_coefficient = 2.7,
    .radiation_area_m2 = 3.0,
    .radiation_coefficient = 1.3,
};

TruthSettings settings_of(const PreciseOrbit& orbit) {
  TruthSettings settings;
  settings.epoch = orbit.epoch;
  settings.forces = SwarmForces{}.model;
  settings.tolerance = 1e-13;
  settings.data_directory = kDataDirectory;
  settings.earth_orientation_file = "earth/eop_swarm_2022.csv";
  settings.space_weather_file = "earth/space_weather_swarm_2022.csv";
  return settings;
}

}  // namespace

SwarmOrbit::SwarmOrbit()
    : orbit_(load_precise_orbit(kDataDirectory / "orbits/swarm_a_2022_001.csv")), settings_(settings_of(orbit_)) {
  EarthRotation rotation(data(120).earth_orientation, orbit_.epoch);
  for (const PreciseState& state : orbit_.states) measured_.push_back(to_eci(state, rotation).position_eci);
  first_state_ = to_eci(orbit_.states.front(), rotation);
}

const ForceData& SwarmOrbit::data(int gravity_degree) {
  const auto found = data_.find(gravity_degree);
  if (found != data_.end()) return found->second;
  TruthSettings settings = settings_;
  settings.gravity_degree = settings.gravity_order = gravity_degree;
  return data_.emplace(gravity_degree, load_force_data(settings)).first->second;
}

std::unique_ptr<SpacecraftDynamics> SwarmOrbit::dynamics(const SwarmForces& forces, const OrbitStart& start) {
  SpacecraftSettings spacecraft{"Swarm A", start.state, kSwarm};
  spacecraft.surface.drag_coefficient *= start.drag_scale;
  TruthSettings settings = settings_;
  settings.forces = forces.model;
  ForceData data = this->data(forces.gravity_degree);
  if (forces.permanent_tide_twice) data.tide_system = TideSystem::kTideFree;
  return std::make_unique<SpacecraftDynamics>(spacecraft.name, data.gravity->gm(), data.gravity->radius(),
                                              EarthRotation(data.earth_orientation, orbit_.epoch),
                                              make_forces(settings, data, spacecraft));
}

Positions SwarmOrbit::propagate(const SwarmForces& forces, const OrbitStart& start) {
  SpacecraftPropagator propagator(dynamics(forces, start), settings_.tolerance, 0.0, start.state);
  Positions positions;
  for (const PreciseState& state : orbit_.states) {
    propagator.advance_to(state.seconds);
    positions.push_back(propagator.state().position_eci);
  }
  return positions;
}

std::vector<ForceAcceleration> SwarmOrbit::mean_sizes(const OrbitStart& start) {
  const auto all = dynamics({}, start);
  EarthRotation rotation(data(120).earth_orientation, orbit_.epoch);
  std::vector<ForceAcceleration> sizes;
  for (const PreciseState& state : orbit_.states) {
    const auto now = all->accelerations(state.seconds, to_eci(state, rotation));
    if (sizes.empty()) {
      sizes = now;
      for (ForceAcceleration& size : sizes) size.acceleration_eci.setZero();
    }
    for (std::size_t i = 0; i < now.size(); ++i) {
      sizes[i].acceleration_eci.x() += now[i].acceleration_eci.norm() / static_cast<double>(orbit_.states.size());
    }
  }
  return sizes;
}

}  // namespace vbar::truth::test
