#pragma once
// Share of a mission's images that a testbed can show if it holds the target by one of its faces.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "hil_drivers/tron/motion_planning/placement.h"
#include "host_sim/mission/mission.h"

namespace vbar::tron {

// Scenes of a mission's camera, from the mission's truth flown ahead.

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

struct FacePlan {
  MountFace face = MountFace::kBottom;
  int images = 0;  ///< sunlit
  int clear = 0;   ///< nothing hidden
  int taken = 0;   ///< at most the accepted number of points hidden
  double sun_error_max_rad = 0.0;
  std::vector<double> move_s, bench_s;                        ///< durations of the images taken
  std::vector<double> wall_s;                                 ///< durations of the search, of all images
  int detours = 0;                                            ///< paths over a retracted posture
  std::vector<std::pair<std::size_t, std::string>> failures;  ///< index of the image, reason

  [[nodiscard]] double share(int count) const { return images > 0 ? static_cast<double>(count) / images : 0.0; }
};

/// Holds the bench time of an image beside its move and its exposure.
struct ImageTimes {
  double settling_s = 0.5;
  double correction_s = 0.0;  ///< duration of one correction, see correction_s_of
};

/// Returns the duration of a correction by 0.2 deg of every axis and 2 mm of the carriage, s: arms as mastered,
/// calibrated.
[[nodiscard]] double correction_s_of(const TestbedDesign& bench);

/// Receives the `share` done, 0 to 1; true ends the search early.
using PlanProgress = std::function<bool(double share)>;

/// Places the sunlit scenes one after the other, each from where the arms stand, from the home posture on. A jump in
/// `blocks` (begin of each; empty: one) begins at a posture that fits, at no cost.
[[nodiscard]] FacePlan plan_face(const TestbedDesign& bench, MountFace face, std::span<const SceneAhead> scenes,
                                 const std::vector<std::size_t>& blocks, const PlacementSettings& settings,
                                 const std::filesystem::path& data_directory, const PlanProgress& progress = {});

/// Returns the quantile of a sample, linear between its values; NaN if it is empty.
[[nodiscard]] double quantile(std::vector<double> sample, double share);

}  // namespace vbar::tron
