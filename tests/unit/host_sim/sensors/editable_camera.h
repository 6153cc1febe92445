#pragma once
// The camera of a loaded mission, to be changed by a test.

#include <algorithm>
#include <memory>

#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {

/// The settings of the first camera, no longer shared with another copy of the mission.
inline CameraSensor& editable_camera(mission::Spacecraft& spacecraft) {
  mission::Sensor& sensor = *std::ranges::find(spacecraft.sensors, "camera", &mission::Sensor::kind);
  auto copy = std::make_shared<CameraSensor>(sensors::settings_of<CameraSensor>(sensor));
  sensor.settings = copy;
  return *copy;
}

inline void remove_camera(mission::Spacecraft& spacecraft) {
  std::erase_if(spacecraft.sensors, [](const mission::Sensor& sensor) { return sensor.kind == "camera"; });
}

}  // namespace vbar::sensors
