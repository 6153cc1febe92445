#pragma once
// A camera file (data/cameras, TOML): optics and detector of a camera, without where it is mounted.

#include <filesystem>
#include <optional>

#include "host_sim/mission/table_reader.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::sensors {

/// Camera as files state it: single pixels, and the number of them that is summed.
struct CameraFile {
  twins::camera::CameraSettings single;  ///< camera of single pixels
  int binning = 1;                       ///< number of pixels each way that are summed into one: 1, 2 or 4
  /// Settings of the sums, stated where binning was in force already: they are used unchanged.
  std::optional<double> gain_dn_per_electron;
  std::optional<twins::camera::Region> region;

  /// Returns the camera whose pixels are the sums, which the rest of the program uses.
  [[nodiscard]] twins::camera::CameraSettings settings() const;
};

/// Loads the camera in the file. What a file leaves out is the Optical Stimulator's. Throws MissionError.
[[nodiscard]] CameraFile load_camera(const std::filesystem::path& file);

/// Reads the keys of a camera that a file and a mission have in common, over what `camera` holds already: exposure_s,
/// region_px, zero_magnitude_photons, the tables optics and detector. Throws MissionError for one that is out of range,
/// and for settings that do not fit together.
void read_camera_settings(const mission::TableReader& section, CameraFile& camera);

}  // namespace vbar::sensors
