#pragma once
// Source: keypoints of a camera that resolves the target, by the pose network.

#include <optional>

#include "fsw/pose/spacecraft_pose_network.h"
#include "fsw/sources/keypoints/keypoint_aiding.h"
#include "fsw/sources/source.h"

namespace vbar::fsw::sources {

struct KeypointSettings {
  pose::PoseCameraSettings camera;
  Matrix3 R_camera_body = Matrix3::Identity();
  double sigma_scale = 1.0;  ///< factor on the network's standard deviations: other illumination than in its training
  double sigma_floor_px = 0.0;  ///< and a standard deviation added to them
  KeypointAidingSettings aiding;
};

class KeypointSource {
 public:
  /// Replaces the settings; the poses collected for initialisation are discarded, the trunk stays.
  void configure(const KeypointSettings& settings);
  void collect(Context& context, RecordFiler records);
  /// Predicts the crop, runs the network and updates the trunk by its keypoints.
  void fold(const Record& record, Context& context, trunk::Trunk& trunk);
  [[nodiscard]] std::optional<GpsTime> owes(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, trunk::Trunk& /*trunk*/) { aiding_.check_age(now); }
  void stop(GpsTime now, trunk::Trunk& trunk);
  /// Telemetry of the image of the step, if there was one.
  void report(const Telemetry& telemetry) const;

  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  [[nodiscard]] const KeypointAiding& aiding() const { return aiding_; }
  [[nodiscard]] GpsTime last_measurement() const { return aiding_.last_accepted(); }
  /// Whether the last image was processed.
  [[nodiscard]] bool has_aided() const { return last_image_ && *last_image_ == aiding_.last_accepted(); }
  /// The direction, in the servicer's RTN, in which the target was seen last: for pointing while its orbit is unknown.
  [[nodiscard]] const std::optional<Vector3>& last_seen_rtn() const { return last_seen_rtn_; }

 private:
  /// Of the trunk after the image, for telemetry.
  struct Estimated {
    pose::TargetPose pose;  ///< of the target with respect to the camera
    bool has_attitude = false;
    Vector3 rate_body = Vector3::Zero();
    Matrix6 attitude_covariance = Matrix6::Zero();
    Vector6 a_roe_m = Vector6::Zero();
    Matrix6 a_roe_covariance_m2 = Matrix6::Zero();
  };

  [[nodiscard]] std::optional<Matrix3> R_camera_eci_at(GpsTime time, const Platform& platform,
                                                       const trunk::Trunk& trunk) const;
  [[nodiscard]] std::optional<Vector3> target_position_camera(const Matrix3& R_camera_eci,
                                                              const trunk::Trunk& trunk) const;
  [[nodiscard]] std::optional<Vector3> predicted_position_camera(const std::optional<Matrix3>& R_camera_eci,
                                                                 const trunk::Trunk& trunk) const;
  void remember_direction(const std::optional<Matrix3>& R_camera_eci, const trunk::Trunk& trunk);
  [[nodiscard]] pose::Keypoints widened(pose::Keypoints keypoints) const;
  void keep_estimate(const std::optional<Matrix3>& R_camera_eci, const trunk::Trunk& trunk);

  KeypointSettings settings_;
  pose::SpacecraftPoseNetwork network_;
  KeypointAiding aiding_;
  pose::Keypoints keypoints_{};  ///< as processed
  std::optional<GpsTime> last_image_;
  std::optional<Vector3> last_seen_rtn_;
  bool has_image_ = false;
  int tiles_missing_ = 0;
  KeypointEditStatus edit_status_ = KeypointEditStatus::kNone;
  std::optional<Estimated> estimated_;
};

}  // namespace vbar::fsw::sources
