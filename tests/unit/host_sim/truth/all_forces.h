#pragma once
// The mission's spacecraft under every force, for the tests of the whole force model.

#include <string>

#include "host_sim/truth/truth_model.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth::test {

inline constexpr SurfaceProperties kMango{154.0, 1.3, 2.5, 2.5, 1.32};

/// Three-hourly indices and a conical shadow: the most jumps and edges there are.
inline constexpr ForceModel kAllForces{.drag = true,
                                       .geomagnetic_index = GeomagneticIndex::kThreeHourly,
                                       .radiation_pressure = true,
                                       .shadow = Shadow::kConical,
                                       .sun = true,
                                       .moon = true,
                                       .solid_tides = true,
                                       .relativity = true};

inline TruthSettings all_forces_settings() {
  TruthSettings settings = mission_settings();
  settings.forces = kAllForces;
  return settings;
}

/// `metres_ahead` of the mission's servicer, on its orbit.
inline SpacecraftSettings mango(const std::string& name = "mango", double metres_ahead = 0.0) {
  return {name, target_state(metres_ahead), kMango};
}

}  // namespace vbar::truth::test
