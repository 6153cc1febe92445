#pragma once
// navigate, by the pose network: from the tiles of an image, the servicer's own GNSS orbit and its star tracker to the
// states of both spacecraft and the attitude of the target.

#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/gnc/camera_pointing.h"
#include "fsw/gnc/inbox.h"
#include "fsw/navigation/gnss_navigation.h"
#include "fsw/navigation/pose_navigation.h"
#include "fsw/pose/spacecraft_pose_network.h"

namespace vbar::fsw::gnc {

class PoseCameraNavigation {
 public:
  /// Restarts with the configurations of camera and pose navigation in the inbox; those not present remain unchanged.
  void configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth);

  /// Processes the image of the step, if there is one. `own_orbit` is propagated here to the time of the image, and by
  /// the caller to `now` afterwards. `burns`: those of the servicer, executed or commanded, in order of time.
  void update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
              std::span<const navigation::Burn> burns);

  /// Commanded pointing of the camera, valid until the next command: the attitude when the star tracker provides none.
  void set_pointing(const Pointing& pointing) { pointing_ = pointing; }

  /// Whether the step had an image, and its result.
  [[nodiscard]] bool has_image() const { return has_image_; }
  [[nodiscard]] int tiles_missing() const { return tiles_missing_; }
  [[nodiscard]] const pose::PoseSighting& sighting() const { return network_.sighting(); }
  [[nodiscard]] navigation::PoseEditStatus edit_status() const { return edit_status_; }
  /// Of the target with respect to the camera at the time of the image, after the update.
  [[nodiscard]] const std::optional<pose::TargetPose>& estimated_pose() const { return estimated_pose_; }

  /// While the target is not acquired: the direction, in the servicer's RTN, in which it was seen last.
  [[nodiscard]] const std::optional<Vector3>& last_seen_rtn() const { return last_seen_rtn_; }

  [[nodiscard]] const navigation::PoseNavigation& filter() const { return filter_; }

 private:
  void take_image(const imaging::ImageAssembly& image, navigation::GnssNavigation& own_orbit,
                  std::span<const navigation::Burn> burns);
  [[nodiscard]] pose::Keypoints widened(pose::Keypoints keypoints) const;
  [[nodiscard]] std::optional<Matrix3> R_camera_eci_at(GpsTime time, const navigation::GnssNavigation& own_orbit,
                                                       const std::optional<orbit::CartesianState>& servicer) const;
  [[nodiscard]] std::optional<Vector3> expected_position() const;
  void watch_for_target(const navigation::PoseEpoch& epoch);
  [[nodiscard]] std::optional<pose::TargetPose> pose_of_estimate(const Matrix3& R_camera_eci) const;

  pose::SpacecraftPoseNetwork network_;
  navigation::PoseNavigation filter_;
  std::optional<camera_configuration> camera_;
  std::optional<pose_configuration> pose_;
  Matrix3 R_camera_body_ = Matrix3::Identity();
  imaging::CameraModel camera_model_;
  std::optional<Pointing> pointing_;
  std::optional<GpsTime> last_image_;
  bool has_image_ = false;
  int tiles_missing_ = 0;
  navigation::PoseEditStatus edit_status_ = navigation::PoseEditStatus::kNone;
  std::optional<pose::TargetPose> estimated_pose_;
  std::optional<Vector3> last_seen_rtn_;
  int unseen_in_a_row_ = 0;      ///< images that should have shown the target but did not
  pose::Keypoints keypoints_{};  ///< as processed by the filter
};

}  // namespace vbar::fsw::gnc
