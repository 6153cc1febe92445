#include "tests/unit/host_sim/truth/swarm/precise_orbit.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

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

}  // namespace vbar::truth::test
