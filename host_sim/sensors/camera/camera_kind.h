#pragma once
// kind = "camera": navigates by images of one spacecraft among all that have a CAD model.

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "fsw/packets/messages.h"
#include "host_sim/engine/clock.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::sensors {

/// Settings of a camera; `observed` is the spacecraft that it navigates to.
struct CameraSensor : mission::SensorSettings {
  std::string camera;  ///< its file as the mission names it, which `settings` began with
  twins::camera::CameraSettings settings;
  engine::Cadence images{fsw::GpsTime{}, fsw::duration_of_seconds(60)};  ///< middles of the exposures
  std::optional<fsw::GpsTime> images_until;  ///< time of the last image at the latest; empty: the end of the run
  /// Exposure of images for keypoints; images for bearings have the exposure of `settings`. The flight software
  /// commands which.
  double keypoint_exposure_s = 0.0;
  fsw::Duration readout;  ///< from the middle of an exposure until the image leaves the camera
  Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::Identity();  ///< camera axes: z boresight, x right, y down
  fsw::Vector3 position_body_m = fsw::Vector3::Zero();                ///< from the centre of mass

  /// Returns the time of the first image at or after `from`; empty after the last one.
  [[nodiscard]] std::optional<fsw::GpsTime> next_image(fsw::GpsTime from) const {
    const fsw::GpsTime next = images.next_at(from);
    return images_until && next > *images_until ? std::nullopt : std::optional(next);
  }
  [[nodiscard]] bool has_use(std::int32_t use) const { return (navigation & use) != 0; }
  [[nodiscard]] bool is_used() const { return navigation != 0; }
  /// Whether navigation uses its images for bearings while the target is a point, keypoints once it is resolved.
  [[nodiscard]] bool changes_use() const { return has_use(kBearings) && has_use(kKeypoints); }

  static constexpr std::int32_t kBearings = vbar::navigation_configuration::kUseBearings;
  static constexpr std::int32_t kKeypoints = vbar::navigation_configuration::kUseKeypoints;
};

/// Returns the camera of that unit whose images navigation uses, and the first one with that use
/// (CameraSensor::kBearings, kKeypoints); null if there is none.
[[nodiscard]] const CameraSensor* navigation_camera(const mission::Spacecraft& carrier, std::uint8_t unit = 0);
[[nodiscard]] const CameraSensor* first_camera_for(std::int32_t use, const mission::Spacecraft& carrier);

/// Returns the unit in packet headers. Cameras whose images navigation uses come first, in the order of the mission;
/// the flight software does not know the others, from packets::kCameras on. By the name of the sensor: its settings may
/// be those of a calibrated copy.
[[nodiscard]] std::uint8_t camera_unit(const mission::Sensor& sensor, const mission::Spacecraft& carrier);

/// Settings of [navigation.angles_only] and [navigation.pose] that do not depend on camera and target.
struct CameraShared : mission::SharedSettings {
  vbar::angles_only_configuration angles_only{};
  vbar::pose_configuration pose{};
};

extern const SensorKind kCamera;

// In camera_evaluation.cpp.
[[nodiscard]] std::unique_ptr<Evaluation> evaluate_camera(const mission::Sensor& sensor,
                                                          const EvaluationContext& context);

// In camera_configuration.cpp.
std::shared_ptr<const mission::SensorSettings> read_camera(const mission::TableReader& section,
                                                           const mission::SensorContext& context);
std::shared_ptr<const mission::SharedSettings> read_camera_shared(const mission::TableReader& document,
                                                                  const mission::Mission& mission);

void add_camera_telecommands(const mission::Sensor& sensor, const TelecommandContext& context,
                             Telecommands& telecommands);

/// Returns the camera as calibrated on the ground: without error.
[[nodiscard]] vbar::camera_configuration camera_configuration_of(const CameraSensor& camera);

/// Returns the target of the camera as configured on the ground: keypoints of its model, inertia of its body. Throws
/// MissionError for files that cannot be read.
[[nodiscard]] vbar::target_model target_model_of(const mission::Mission& mission, const CameraSensor& camera,
                                                 const std::filesystem::path& data_directory);

}  // namespace vbar::sensors
