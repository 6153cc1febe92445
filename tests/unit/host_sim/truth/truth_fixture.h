#pragma once
// The mission's start and the data folder, for the tests of the truth.

#include <filesystem>

#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/orbit_geometry.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"

namespace vbar::truth::test {

inline const std::filesystem::path kDataDirectory = std::filesystem::path(vbar::tests::source_path("data"));

inline constexpr double kGm = 3.986004415e14;      // GGM05S
inline constexpr double kEarthRadius = 6378136.3;  // GGM05S
inline constexpr double kDegree = 3.14159265358979323846 / 180.0;

inline fsw::GpsTime mission_epoch() {
  return gps_from_utc("2011-07-18T01:00:00Z");
}

/// The servicer's osculating elements as the mission's table prints them.
inline fsw::orbit::QnsElements servicer_elements() {
  return {7087300.0, 0.0015, -4.17e-8, 98.18 * kDegree, -90.0 * kDegree, -0.69 * kDegree};
}

inline fsw::orbit::CartesianState servicer_state() {
  return orbit_geometry(servicer_elements(), kGm).state;
}

/// A target `along_track_m` ahead of the servicer on the same orbit.
inline fsw::orbit::CartesianState target_state(double along_track_m) {
  fsw::orbit::QnsElements elements = servicer_elements();
  elements.u += along_track_m / elements.a;
  return orbit_geometry(elements, kGm).state;
}

/// Gravity alone, at a tolerance whose errors over the mission stay below the claims of the accuracy tests.
inline TruthSettings mission_settings() {
  TruthSettings settings;
  settings.tolerance = 1e-13;
  settings.epoch = mission_epoch();
  settings.data_directory = kDataDirectory;
  return settings;
}

inline bool same_bits(const fsw::orbit::CartesianState& a, const fsw::orbit::CartesianState& b) {
  return a.position_eci == b.position_eci && a.velocity_eci == b.velocity_eci;
}

}  // namespace vbar::truth::test
