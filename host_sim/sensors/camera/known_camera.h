#pragma once
// A camera as calibrated on the ground: the mission's camera or, for a testbed that calibrates its camera, the
// calibrated one.

#include <filesystem>
#include <optional>

#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {

struct KnownCamera {
  CameraSensor sensor;
  std::optional<double> centroid_floor_px;
};

/// Throws MissionError for a calibration that cannot be read.
[[nodiscard]] KnownCamera known_camera(const CameraSensor& camera, const mission::Mission& mission,
                                       const std::filesystem::path& data_directory);

}  // namespace vbar::sensors
