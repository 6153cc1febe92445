#pragma once
// A camera as calibrated on the ground: the mission's camera or, for a testbed that calibrates its camera, the
// calibrated one.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/twins/camera/camera_sensor.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/scene.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::sensors {

struct KnownCamera {
  CameraSensor sensor;
  std::optional<double> centroid_floor_px;
};

/// Throws MissionError for a calibration that cannot be read.
[[nodiscard]] KnownCamera known_camera(const CameraSensor& camera, const mission::Mission& mission,
                                       const std::filesystem::path& data_directory);

// Cameras of a mission as packet sources, and the tiles of their images out of a log.

/// Makes the scene of all objects that the spacecraft's camera can see. Null projection: through the lens of `camera`.
/// Throws what data files throw.
[[nodiscard]] std::unique_ptr<twins::camera::SceneRenderer> make_scene(
    const mission::Mission& mission, const mission::Spacecraft& spacecraft, const twins::camera::CameraSettings& camera,
    const std::filesystem::path& data_directory, std::shared_ptr<const twins::camera::Projection> projection = nullptr);

/// Makes the digital twin of the camera of `servicer`, whatever the source of its images. Throws what data files throw.
[[nodiscard]] std::unique_ptr<twins::camera::ImageMaker> make_digital_camera(
    const mission::Mission& mission, const mission::Spacecraft& servicer, const mission::Sensor& sensor,
    const std::filesystem::path& data_directory);

/// Returns the place of the camera on its spacecraft, and the models that it can see. Throws what data files throw.
[[nodiscard]] twins::camera::CameraMount mount_of(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                                  const CameraSensor& camera,
                                                  const std::filesystem::path& data_directory);

/// Makes the source of the camera's packets, with images by `taker`. Images that navigation does not use are in the log
/// only.
[[nodiscard]] std::unique_ptr<twins::PacketSource> make_camera(const mission::Mission& mission,
                                                               const mission::Spacecraft& servicer,
                                                               const mission::Sensor& sensor,
                                                               const std::filesystem::path& data_directory,
                                                               std::unique_ptr<twins::camera::ImageTaker> taker);

/// Restores the tiles of a log of this camera. `make_digital` is called when the first image is to be rendered, since a
/// renderer is large.
[[nodiscard]] std::unique_ptr<twins::TileSource> make_recorded_tile_source(
    const std::function<std::unique_ptr<twins::camera::ImageMaker>()>& make_digital, twins::ImagesOfLog&& images);

/// Restores the tiles of all cameras of a servicer, for a replay.
[[nodiscard]] std::unique_ptr<twins::TileSource> make_camera_tile_source(const RestoreContext& context,
                                                                         twins::ImagesOfLog&& images);

}  // namespace vbar::sensors
