#pragma once
// A camera file (data/cameras, TOML): optics and detector of a camera, without where it is mounted.

#include <filesystem>

#include "host_sim/mission/table_reader.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::mission {

/// The camera in the file. What a file leaves out is the Optical Stimulator's. Throws MissionError.
[[nodiscard]] twins::camera::CameraSettings load_camera(const std::filesystem::path& file);

/// The keys of a camera that a file and a mission have in common, over what `settings` holds already: exposure_s,
/// region_px, zero_magnitude_photons, the tables optics and detector. Throws MissionError for one that is out of
/// range, and for settings that do not fit together.
void read_camera_settings(const TableReader& section, twins::camera::CameraSettings& settings);

}  // namespace vbar::mission
