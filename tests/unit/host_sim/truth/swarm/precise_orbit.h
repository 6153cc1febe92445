#pragma once
// The measured orbit of a real satellite, as a reference for propagated ones.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/force_list.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "host_sim/truth/truth_settings.h"

namespace vbar::truth::test {

struct PreciseState {
  double seconds = 0.0;  ///< after the first
  fsw::Vector3 position_itrf = fsw::Vector3::Zero();
  fsw::Vector3 velocity_itrf = fsw::Vector3::Zero();  ///< relative to the rotating Earth
};

struct PreciseOrbit {
  fsw::GpsTime epoch;  ///< of the first state
  std::vector<PreciseState> states;
};

/// Reads a file of the columns of data/orbits/swarm_a_2022_001.csv. Throws std::runtime_error naming the line.
PreciseOrbit load_precise_orbit(const std::filesystem::path& file);

/// Position and velocity in GCRF of a state of an orbit; `rotation` about the orbit's epoch.
fsw::orbit::CartesianState to_eci(const PreciseState& state, EarthRotation& rotation);

// Least squares of a propagated orbit against a measured one: the six components of the start and the scale of drag.

/// What is adjusted.
struct OrbitStart {
  fsw::orbit::CartesianState state;
  double drag_scale = 1.0;
};

/// Positions (m, ECI) at the instants of the measured orbit.
using Positions = std::vector<fsw::Vector3>;
using Propagate = std::function<Positions(const OrbitStart&)>;

/// The distances between two orbits at the same instants, m.
struct Distances {
  double rms = 0.0;
  double largest = 0.0;
};
Distances distances(const Positions& a, const Positions& b);

/// Gauss-Newton. The derivatives, by differences of propagations, are made once about `first` and serve all fits from
/// near it: a force more or less changes them by parts in a thousand, so that each iteration still gains three digits.
class OrbitFit {
 public:
  OrbitFit(const Propagate& propagate, const OrbitStart& first, Positions measured);

  /// The start that makes the positions of `propagate` fit best; the drag scale is left as it is unless `fits_drag`.
  OrbitStart fit(const Propagate& propagate, const OrbitStart& first, bool fits_drag = true) const;

 private:
  static constexpr int kParameters = 7;
  using Parameters = Eigen::Matrix<double, kParameters, 1>;

  static OrbitStart displaced(const OrbitStart& start, const Parameters& by);

  Positions measured_;
  Eigen::Matrix<double, Eigen::Dynamic, kParameters> derivatives_;  ///< of positions, in units of the steps
};

// Swarm A on 2022-01-01: its precise orbit and the forces on it, any of which can be left out.

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
