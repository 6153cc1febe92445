#pragma once
// Keys of [navigation] by which the process noise of the relative orbit follows from physics
// (host_sim/installation/expected_accelerations.h).

#include <optional>
#include <string>
#include <vector>

#include "host_sim/mission/mission.h"

namespace vbar::mission {

/// Bounds of a surface coefficient times area over mass, m^2/kg.
struct SurfaceBounds {
  double min_m2_per_kg = 0.0;
  double max_m2_per_kg = 0.0;
};

struct ProcessNoiseKeys final : SharedSettings {
  bool are_stated = false;                        ///< the file states process noise or its upper limit: they are kept
  std::optional<SurfaceBounds> target_drag;       ///< as known before the flight; empty: half to one and a half
  std::optional<SurfaceBounds> target_radiation;  ///< of the nominal value of the spacecraft that is observed
  std::vector<std::string> without_effect;        ///< a sentence on each key that no source of the mission uses
};

}  // namespace vbar::mission
