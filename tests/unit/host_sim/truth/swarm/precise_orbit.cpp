#include "tests/unit/host_sim/truth/swarm/precise_orbit.h"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

namespace vbar::truth::test {
namespace {

/// GPS time of a calendar date in GPS time.
fsw::GpsTime gps_time(int year, int month, int day, int hour, int minute, int second) {
  // Days since the GPS epoch by the Gregorian calendar, counted from March 1 of a year 0 (Richards 2013).
  const int y = month > 2 ? year : year - 1, m = month > 2 ? month - 3 : month + 9;
  const std::int64_t days = 365LL * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 723125;
  return {(((days * 24 + hour) * 60 + minute) * 60 + second) * fsw::kNanosecondsPerSecond};
}

}  // namespace

PreciseOrbit load_precise_orbit(const std::filesystem::path& file) {
  std::ifstream in(file);
  PreciseOrbit orbit;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("#") || line.starts_with("gps_time,")) continue;
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    PreciseState s;
    fsw::Vector3 &r = s.position_itrf, &v = s.velocity_itrf;
    if (std::sscanf(line.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d,%lf,%lf,%lf,%lf,%lf,%lf", &year, &month, &day, &hour,
                    &minute, &second, &r.x(), &r.y(), &r.z(), &v.x(), &v.y(), &v.z()) != 12) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": expected a time and six numbers");
    }
    const fsw::GpsTime time = gps_time(year, month, day, hour, minute, second);
    if (orbit.states.empty()) orbit.epoch = time;
    s.seconds = fsw::seconds(time - orbit.epoch);
    orbit.states.push_back(s);
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
