#include "tests/unit/host_sim/truth/swarm/precise_orbit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/QR>

#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/support/figures.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth::test {

PreciseOrbit load_precise_orbit(const std::filesystem::path& file) {
  std::ifstream in(file);
  PreciseOrbit orbit;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("#") || line.starts_with("gps_time_s,")) continue;
    std::istringstream cells(line);
    std::int64_t gps_s = 0;
    std::array<double, 6> x{};
    cells >> gps_s;
    for (double& value : x) {
      char comma = 0;
      cells >> comma >> value;
    }
    if (!cells || !cells.eof()) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": expected a time and six numbers");
    }
    const fsw::GpsTime time{gps_s * fsw::kNanosecondsPerSecond};
    if (orbit.states.empty()) orbit.epoch = time;
    orbit.states.push_back({fsw::seconds(time - orbit.epoch), {x[0], x[1], x[2]}, {x[3], x[4], x[5]}});
  }
  if (orbit.states.empty()) throw std::runtime_error(file.string() + ": no states");
  return orbit;
}

fsw::orbit::CartesianState to_eci(const PreciseState& state, EarthRotation& rotation) {
  // The rotation's rate by central differences over 1 s: truncation (7e-5)^3/6 of 7000 km, below 1e-6 m/s.
  const fsw::Matrix3 to_gcrf = rotation.R_itrf_gcrf_at(state.seconds).transpose();
  const fsw::Matrix3 rate =
      (rotation.R_itrf_gcrf_at(state.seconds + 0.5) - rotation.R_itrf_gcrf_at(state.seconds - 0.5)).transpose();
  return {to_gcrf * state.position_itrf, to_gcrf * state.velocity_itrf + rate * state.position_itrf};
}

namespace {

/// Steps of the differences: 10 m, 1 cm/s, a tenth of drag. Small enough for the orbit to answer linearly (1e-5 of it),
/// large beside the propagation's error of some micrometres.
constexpr double kSteps[7] = {10.0, 10.0, 10.0, 0.01, 0.01, 0.01, 0.1};

Eigen::VectorXd stacked_difference(const Positions& a, const Positions& b) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(3 * a.size()));
  for (std::size_t i = 0; i < a.size(); ++i) result.segment<3>(static_cast<Eigen::Index>(3 * i)) = a[i] - b[i];
  return result;
}

}  // namespace

Distances distances(const Positions& a, const Positions& b) {
  double sum = 0.0;
  accuracy::Largest largest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double distance = (a[i] - b[i]).norm();
    sum += distance * distance;
    largest.add(distance);
  }
  return {std::sqrt(sum / static_cast<double>(a.size())), largest};
}

OrbitStart OrbitFit::displaced(const OrbitStart& start, const Parameters& by) {
  OrbitStart result = start;
  for (int i = 0; i < 3; ++i) {
    result.state.position_eci[i] += by[i] * kSteps[i];
    result.state.velocity_eci[i] += by[i + 3] * kSteps[i + 3];
  }
  result.drag_scale += by[6] * kSteps[6];
  return result;
}

OrbitFit::OrbitFit(const Propagate& propagate, const OrbitStart& first, Positions measured)
    : measured_(std::move(measured)), derivatives_(static_cast<Eigen::Index>(3 * measured_.size()), kParameters) {
  for (int i = 0; i < kParameters; ++i) {
    const Parameters half = 0.5 * Parameters::Unit(i);
    derivatives_.col(i) = stacked_difference(propagate(displaced(first, half)), propagate(displaced(first, -half)));
  }
}

OrbitStart OrbitFit::fit(const Propagate& propagate, const OrbitStart& first, bool fits_drag) const {
  const int parameters = fits_drag ? kParameters : kParameters - 1;
  const auto decomposition = derivatives_.leftCols(parameters).colPivHouseholderQr();
  OrbitStart start = first;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Parameters by = Parameters::Zero();
    by.head(parameters) = decomposition.solve(stacked_difference(measured_, propagate(start)));
    start = displaced(start, by);
    // A thousandth of a step moves no position by more than a centimetre or two; the next iteration would gain three
    // digits on that.
    if (accuracy::largest_entry(by) < 1e-4) return start;
  }
  throw std::runtime_error("the fit of the orbit did not converge");
}

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
