#pragma once
// The measured orbit of a real satellite, as a reference for propagated ones.

#include <filesystem>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/earth_rotation.h"

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

}  // namespace vbar::truth::test
