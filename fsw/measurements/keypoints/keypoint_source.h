#pragma once
// Source: keypoints of the cameras that resolve the target, by the pose network.

#include <array>
#include <optional>

#include "fsw/measurements/calibrated_camera.h"
#include "fsw/measurements/keypoints/keypoint_aiding.h"
#include "fsw/measurements/keypoints/keypoint_settings.h"
#include "fsw/measurements/keypoints/resolution.h"
#include "fsw/measurements/source.h"
#include "fsw/vision/pose/spacecraft_pose_network.h"

namespace vbar::fsw::measurements {

class KeypointSource {
 public:
  static constexpr std::int32_t kUse = KeypointEditing::kSource.bit;
  /// Takes the settings of all cameras that are configured for keypoints, with the model of the target. A change
  /// discards the poses collected for initialisation; the filter stays.
  bool configure(const Configuration& configuration);
  /// At most one image of each camera in a step.
  void collect(Context& context, RecordFiler records);
  /// Predicts the crop, runs the network and updates the filter by its keypoints.
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, filter::RelativeNavigationFilter& filter);
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter);
  /// Telemetry of the images of the step.
  void report(const Telemetry& telemetry) const;

  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  [[nodiscard]] const KeypointAiding& aiding() const { return aiding_; }
  [[nodiscard]] GpsTime last_measurement() const { return aiding_.last_accepted(); }
  /// Whether the last image was processed.
  [[nodiscard]] bool has_aided() const { return last_image_ && *last_image_ == aiding_.last_accepted(); }
  /// The exposure that a camera with two uses shall take its next images with; empty for any other.
  [[nodiscard]] std::optional<double> wanted_exposure_s(std::size_t camera) const;
  /// The direction, in the servicer's RTN, in which the target was seen last: for pointing while its orbit is unknown.
  [[nodiscard]] const std::optional<Vector3>& last_seen_rtn() const { return last_seen_rtn_; }

 private:
  /// A camera, and the telemetry of its image of the step.
  struct Camera {
    std::optional<KeypointCameraSettings> settings;
    std::optional<TwoExposures> exposures;         ///< if it takes images for bearings too
    Resolution resolution = Resolution::kUnknown;  ///< of such a camera
    ExposureScheduler scheduler;                   ///< of such a camera
    std::optional<GpsTime> last_image;
    std::optional<telemetry_pose> report;
  };

  [[nodiscard]] static bool shows_keypoints(const Camera& camera, double exposure_s);
  [[nodiscard]] static std::optional<Matrix3> R_camera_eci_at(GpsTime time, const Matrix3& R_camera_body,
                                                              const Platform& platform,
                                                              const filter::RelativeNavigationFilter& filter);
  void remember_direction(const KeypointCameraSettings& camera, const std::optional<Matrix3>& R_camera_eci,
                          const filter::RelativeNavigationFilter& filter);
  [[nodiscard]] telemetry_pose report_of(const KeypointImage& image, KeypointEditStatus edit_status, int tiles_missing,
                                         const filter::RelativeNavigationFilter& filter) const;

  std::array<Camera, packets::kCameras> cameras_;
  pose::SpacecraftPoseNetwork network_;  ///< with the settings of the camera of the last image
  KeypointAiding aiding_;
  pose::Keypoints keypoints_{};  ///< as processed
  std::optional<GpsTime> last_image_;
  std::optional<Vector3> last_seen_rtn_;
};

/// Returns the position of the target's centre of mass with respect to the camera, in its axes, m. kNotReady without a
/// target.
Result<Vector3> target_position_camera(const KeypointCamera& camera, const Matrix3& R_camera_eci,
                                       const filter::RelativeNavigationFilter& filter);

}  // namespace vbar::fsw::measurements
