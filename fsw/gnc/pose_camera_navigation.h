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
  /// Starts anew with the inbox's configurations of camera and pose navigation; what is not there stays as it was.
  void configure(GpsTime now, Inbox& inbox, const orbit::EarthOrientation& earth);

  /// Takes the step's image, if there is one. `own_orbit`, to be brought to `now` afterwards, is brought to the image's
  /// time here. `burns`: the servicer's, known or commanded, in order of time.
  void update(GpsTime now, Inbox& inbox, navigation::GnssNavigation& own_orbit,
              std::span<const navigation::Burn> burns);

  /// The camera is told this until it is told otherwise: the attitude where the star tracker has none.
  void set_pointing(const Pointing& pointing) { pointing_ = pointing; }

  /// Whether the step had an image, and what came of it.
  [[nodiscard]] bool has_image() const { return has_image_; }
  [[nodiscard]] int tiles_missing() const { return tiles_missing_; }
  [[nodiscard]] const pose::PoseSighting& sighting() const { return network_.sighting(); }
  [[nodiscard]] navigation::PoseFate fate() const { return fate_; }
  /// Of the target against the camera at the image's time, as navigation has it after the image.
  [[nodiscard]] const std::optional<pose::TargetPose>& estimated_pose() const { return estimated_pose_; }

  /// While nothing is known of the target: the direction, in the servicer's RTN, in which it was seen last.
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
  navigation::PoseFate fate_ = navigation::PoseFate::kNone;
  std::optional<pose::TargetPose> estimated_pose_;
  std::optional<Vector3> last_seen_rtn_;
  int unseen_in_a_row_ = 0;      ///< images that should have shown the target and did not
  pose::Keypoints keypoints_{};  ///< as the filter took them
};

}  // namespace vbar::fsw::gnc
