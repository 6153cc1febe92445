#include "host_sim/sensors/camera/known_camera.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "host_sim/sensors/installed_testbeds.h"

namespace vbar::sensors {

KnownCamera known_camera(const CameraSensor& camera, const mission::Mission& mission,
                         const std::filesystem::path& data_directory) {
  KnownCamera known{camera, std::nullopt};
  const testbeds::TestbedKind* const testbed = testbeds::find_testbed(camera.source);
  if (testbed == nullptr || testbed->calibrated_camera == nullptr) return known;
  const auto of_mission = std::ranges::find(mission.testbeds, testbed->name, &mission::Testbed::name);
  if (of_mission == mission.testbeds.end())
    throw std::logic_error("the mission has no [testbed." + std::string(testbed->name) + "]");
  const auto calibrated = testbed->calibrated_camera(*of_mission->settings, mission, data_directory, camera.settings);
  known.sensor.settings = calibrated.settings;
  known.centroid_floor_px = calibrated.centroid_floor_px;
  return known;
}

}  // namespace vbar::sensors
