#pragma once
// Scenes of a mission's camera, from the mission's truth flown ahead.

#include <functional>
#include <vector>

#include "hil_drivers/tron/placement/scene.h"
#include "host_sim/mission/mission.h"

namespace vbar::tron {

/// Holds an image that is due.
struct SceneAhead {
  double time_s = 0.0;  ///< since the mission's epoch
  double exposure_s = 0.0;
  Scene scene;
};

/// Flies the mission ahead of time in this program: true states take the place of its sensors, so that its maneuvers
/// and pointing are those of a flight without errors of navigation. The navigation camera is not exposed; its scenes
/// are noted, lengths times `scale`. Throws mission::MissionError if no camera navigates by another spacecraft or that
/// has no model, and what the truth throws. `stop_requested` ends it early.
[[nodiscard]] std::vector<SceneAhead> fly_ahead(const mission::Mission& mission,
                                                const std::filesystem::path& data_directory, double scale,
                                                const std::function<void(fsw::Duration)>& progress,
                                                const std::function<bool()>& stop_requested);

}  // namespace vbar::tron
