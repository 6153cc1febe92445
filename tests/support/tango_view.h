#pragma once
// Tango before the close-range camera: where its keypoints are on it and on the detector, with or without noise.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/keypoint.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::test {

/// The published keypoints from the centre of mass (data/bodies/tango.toml).
inline fsw::pose::KeypointShape tango_shape() {
  using fsw::Vector3;
  fsw::pose::KeypointShape shape{
      Vector3(-0.37, -0.385, 0.3215),  Vector3(-0.37, 0.385, 0.3215), Vector3(0.37, 0.385, 0.3215),
      Vector3(0.37, -0.385, 0.3215),   Vector3(-0.37, -0.264, 0.0),   Vector3(-0.37, 0.304, 0.0),
      Vector3(0.37, 0.304, 0.0),       Vector3(0.37, -0.264, 0.0),    Vector3(-0.5427, 0.4877, 0.2535),
      Vector3(0.5427, 0.4877, 0.2591), Vector3(0.305, -0.579, 0.2515)};
  for (Vector3& point : shape) point -= Vector3(0.0, 0.018823529411764704, 0.160794117647059);
  return shape;
}

/// 17 mm before pixels of 11.72 um, 960 x 600 of them, with the distortion of the published camera.
inline fsw::imaging::CameraModel close_camera() {
  return {.focal_length_px = {1450.5, 1450.5},
          .principal_point_px = {479.75, 299.75},
          .distortion = {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243}};
}

/// Any attitude, and a place within the middle of the field.
inline fsw::pose::TargetPose random_pose(std::mt19937_64& random, double nearest_m, double farthest_m) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  const double depth = nearest_m + 0.5 * (farthest_m - nearest_m) * (1.0 + uniform(random));
  const double right = 0.15 * depth * uniform(random);
  const double down = 0.1 * depth * uniform(random);
  return {Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix(), fsw::Vector3(right, down, depth)};
}

/// All keypoints usable, where the pose puts them plus Gaussian noise of `sigma_px` an axis; the covariance is that of
/// `claimed_px`.
inline fsw::pose::Keypoints seen_keypoints(const fsw::pose::TargetPose& pose, double sigma_px, double claimed_px,
                                           std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const fsw::pose::KeypointShape shape = tango_shape();
  fsw::pose::Keypoints keypoints;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const fsw::Vector3 point = pose.R_camera_body * shape[k] + pose.position_camera_m;
    const double dx = sigma_px * normal(random);
    const double dy = sigma_px * normal(random);
    keypoints[k].pixel = fsw::imaging::pixel_of(close_camera(), point).value() + fsw::Vector2(dx, dy);
    keypoints[k].covariance_px2 = claimed_px * claimed_px * fsw::Matrix2::Identity();
    keypoints[k].peak = 1.0;
    keypoints[k].is_usable = true;
  }
  return keypoints;
}

/// The turn that leads from one attitude to the other, about the camera's axes, rad.
inline fsw::Vector3 turn_between(const fsw::Matrix3& from, const fsw::Matrix3& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to * from.transpose()));
  return turn.angle() * turn.axis();
}

}  // namespace vbar::test
