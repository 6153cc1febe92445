#include "tests/unit/host_sim/truth/swarm/swarm_forces.h"

#include <utility>

#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/gravity_force.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/forces/relativity_force.h"
#include "host_sim/truth/forces/solid_tides_force.h"
#include "host_sim/truth/forces/third_body_force.h"
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

constexpr double kTolerance = 1e-13;

}  // namespace

SwarmOrbit::SwarmOrbit()
    : orbit_(load_precise_orbit(kDataDirectory / "orbits/swarm_a_2022_001.csv")),
      orientation_(std::make_shared<const EarthOrientationSeries>(
          EarthOrientationSeries::load(kDataDirectory / "earth/eop_swarm_2022.csv"))),
      space_weather_(std::make_shared<const SpaceWeather>(
          SpaceWeather::load(kDataDirectory / "earth/space_weather_swarm_2022.csv"))),
      atmosphere_(std::make_shared<const Nrlmsise00Tables>(
          load_nrlmsise00_tables(kDataDirectory / "atmosphere/nrlmsise00.csv"))),
      gravity_(load_gravity_coefficients(kDataDirectory / "gravity/ggm05s_120.txt", 120)) {
  EarthRotation rotation(orientation_, orbit_.epoch);
  for (const PreciseState& state : orbit_.states) measured_.push_back(to_eci(state, rotation).position_eci);
  first_state_ = to_eci(orbit_.states.front(), rotation);
}

std::unique_ptr<SpacecraftDynamics> SwarmOrbit::dynamics(const SwarmForces& on, double drag_scale) const {
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::make_unique<GravityForce>(
      std::make_shared<const GravityField>(gravity_, on.gravity_degree, on.gravity_degree)));
  if (on.drag) {
    SurfaceProperties scaled = kSwarm;
    scaled.drag_coefficient *= drag_scale;
    forces.push_back(
        std::make_unique<DragForce>(scaled, atmosphere_, space_weather_, GeomagneticIndex::kThreeHourly, orbit_.epoch));
  }
  if (on.radiation_pressure) forces.push_back(std::make_unique<RadiationPressureForce>(kSwarm, Shadow::kConical));
  if (on.sun) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun));
  if (on.moon) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon));
  if (on.solid_tides) {
    const TideSystem system = on.permanent_tide_twice ? TideSystem::kTideFree : tide_system_named(gravity_.tide_system);
    forces.push_back(
        std::make_unique<SolidTidesForce>(gravity_.gm, gravity_.radius, system, orbit_.epoch, orientation_));
  }
  if (on.relativity) forces.push_back(std::make_unique<RelativityForce>(gravity_.gm));
  return std::make_unique<SpacecraftDynamics>("Swarm A", gravity_.gm, gravity_.radius,
                                              EarthRotation(orientation_, orbit_.epoch), std::move(forces));
}

Positions SwarmOrbit::propagate(const SwarmForces& forces, const OrbitStart& start) const {
  SpacecraftPropagator propagator(dynamics(forces, start.drag_scale), kTolerance, 0.0, start.state);
  Positions positions;
  for (const PreciseState& state : orbit_.states) {
    propagator.advance_to(state.seconds);
    positions.push_back(propagator.state().position_eci);
  }
  return positions;
}

std::vector<ForceAcceleration> SwarmOrbit::mean_sizes(const OrbitStart& start) const {
  const auto all = dynamics({}, start.drag_scale);
  EarthRotation rotation(orientation_, orbit_.epoch);
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
