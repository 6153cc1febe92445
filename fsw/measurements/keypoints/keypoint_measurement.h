#pragma once
// Measurement models of a camera that resolves the target: rows of the filter for its keypoints, or for its position
// alone.

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/keypoint.h"

namespace vbar::fsw::measurements {

/// Position and attitude of the camera at an image.
struct CameraPose {
  Matrix3 R_camera_eci = Matrix3::Identity();
  Vector3 origin_eci = Vector3::Zero();  ///< from the servicer's centre of mass, m
};

struct KeypointModel {
  std::size_t camera = 0;  ///< whose mount applies
  imaging::CameraModel optics;
  pose::KeypointShape shape{};         ///< body axes from the centre of mass of the model, m
  double lasting_stretch_scale = 1.0;  ///< of the image, 1 and above: that of a small image is less certain
};

/// Whether the network considers it usable and its covariance is one.
[[nodiscard]] bool is_usable(const pose::Keypoint& keypoint);

/// Index in the state of the mount of a camera.
constexpr int mount_at(std::size_t camera) {
  return filter::kAt<CameraMounts> + kMountAxes * static_cast<int>(camera);
}

/// Fills the batch with two components of each keypoint, measured minus predicted (px): those of keypoint k are rows
/// 2k and 2k + 1. Keypoints that are not usable, or behind the camera for one of the sigma points, are not in use. The
/// filter stands at the time of the image and has an attitude. Any status of the orbit conversions, or kSingular for
/// an invalid covariance.
///
/// Model: pixel of R_camera_eci (rho - o) + R_camera_body (p_k + origin), shifted by the error of its mount, plus the
/// errors that all keypoints or successive images have in common (keypoint_blocks.h). ROE and rotation are
/// sampled, all others enter linearly. The correlated share of a keypoint's covariance is a state in units of its root;
/// the rest is noise.
Status keypoint_rows(const filter::RelativeNavigationFilter& filter, const pose::Keypoints& keypoints,
                     const CameraPose& camera, const KeypointModel& model, filter::MeasurementBatch& batch);

/// Fills the batch with a position of the target from the servicer's centre of mass, m, ECI axes, as from the pose of
/// one image. Status as above.
Status position_rows(const filter::RelativeNavigationFilter& filter, const Vector3& relative_eci,
                     const Matrix3& covariance_m2, filter::MeasurementBatch& batch);

}  // namespace vbar::fsw::measurements
