#include "fsw/measurements/keypoints/keypoint_measurement.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/vision/target_tracking/bearing.h"

namespace vbar::fsw::measurements {
namespace {

using filter::kAt;

constexpr int kCount = pose::kKeypoints;
constexpr int kRows = 2 * kCount;
constexpr int kSampled = filter::Roe::kSize + filter::AttitudeError::kSize;
constexpr int kLastingTurn = kAt<KeypointCommon> + KeypointCommon::kLastingTurn;

// Points at 1.8 standard deviations; the central point's weight in a covariance stays above zero.
constexpr estimation::UnscentedParameters kPoints = {.alpha = 0.6, .beta = 2.0, .kappa = 0.0};

using Transform = estimation::UnscentedTransform<kSampled>;
using Pixels = Eigen::Matrix<double, kRows, 1>;

/// Index in the state of the sampled component k.
constexpr int sampled_index(int k) {
  return k < filter::Roe::kSize ? kAt<filter::Roe> + k : kAt<filter::AttitudeError> + k - filter::Roe::kSize;
}

constexpr std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

Status start(Transform& transform, const filter::Estimate& estimate) {
  Transform::Vector mean;
  Transform::Matrix covariance;
  for (int r = 0; r < kSampled; ++r) {
    mean(r) = estimate.mean(sampled_index(r));
    for (int c = 0; c < kSampled; ++c) covariance(r, c) = estimate.covariance(sampled_index(r), sampled_index(c));
  }
  return transform.start(mean, covariance, kPoints);
}

/// Cholesky factor, lower.
Matrix2 root_of(const Matrix2& covariance) {
  const double a = math::sqrt(covariance(0, 0));
  const double b = covariance(1, 0) / a;
  Matrix2 root;
  root << a, 0.0, b, math::sqrt(covariance(1, 1) - b * b);
  return root;
}

/// The pose of the target with respect to the camera, for one sigma point.
struct Seen {
  Vector3 centre_camera = Vector3::Zero();  ///< centre of mass, m
  Matrix3 R_camera_body = Matrix3::Identity();
};

Result<Seen> pose_of(const Transform::Vector& x, const filter::RelativeNavigationFilter& filter,
                     const orbit::QnsElements& chief, const CameraPose& camera) {
  const auto target = orbit::target_from_roe(chief, x.head<6>());
  if (!target.ok()) return target.status();
  const Vector3 sight = target.value().position_eci - filter.servicer().position_eci - camera.origin_eci;
  const Eigen::Quaterniond q_eci_body = filter.attitude().state().q_eci_body * filter::quaternion_of_grp(x.tail<3>());
  return Seen{camera.R_camera_eci * sight, camera.R_camera_eci * q_eci_body.toRotationMatrix()};
}

/// Sensitivities of the states that enter linearly, at the mean pose; false if the target is behind the camera.
bool add_linear_states(const filter::RelativeNavigationFilter& filter, const pose::Keypoints& keypoints,
                       const CameraPose& camera, const KeypointModel& model, const Seen& mean, const Pixels& predicted,
                       filter::MeasurementBatch& batch) {
  const filter::Estimate& estimate = filter.estimate();
  const auto centre_px = imaging::pixel_of(model.optics, mean.centre_camera);
  if (!centre_px.ok()) return false;
  const double share = filter.settings().processes.of<KeypointCommon>().correlated_share;
  const Vector3 sight_eci = camera.R_camera_eci.transpose() * mean.centre_camera;
  const Matrix3 axes = target_tracking::bearing_axes(sight_eci.normalized(), filter.servicer());
  const int mount = mount_at(model.camera);
  const int stretch = kAt<KeypointCommon> + KeypointCommon::kLastingStretch + static_cast<int>(model.camera);
  const Vector3 origin = estimate.mean().segment<3>(kAt<KeypointOrigin>);
  for (int k = 0; k < kCount; ++k) {
    const int row = 2 * k;
    if (!batch.is_used[at(row)]) continue;
    const Vector3 point = mean.centre_camera + mean.R_camera_body * (model.shape[at(k)] + origin);
    const auto projection = imaging::project(model.optics, point);
    if (!projection.ok()) {
      batch.is_used[at(row)] = batch.is_used[at(row + 1)] = false;
      continue;
    }
    const Eigen::Matrix<double, 2, 3> by_point = projection.value().derivative;
    const Eigen::Matrix<double, 2, 3> by_origin = by_point * mean.R_camera_body;
    const Eigen::Matrix<double, 3, 2> across = camera.R_camera_eci * axes.topRows<2>().transpose();
    const Matrix2 by_mount = math::sqrt(point.squaredNorm()) * by_point * across;
    const Matrix2 covariance = keypoints[at(k)].covariance_px2;
    const Matrix2 root = math::sqrt(share) * root_of(covariance);
    for (int axis = 0; axis < 2; ++axis) {
      auto sensitivity = batch.sensitivity.col(row + axis);
      sensitivity.segment<3>(kAt<KeypointOrigin>) = by_origin.row(axis).transpose();
      sensitivity.segment<2>(mount) = by_mount.row(axis).transpose();
      const double from_centre = predicted(row + axis) - centre_px.value()(axis);
      sensitivity(kAt<KeypointCommon> + axis) = 1.0;
      sensitivity(kAt<KeypointCommon> + 2) = from_centre;
      sensitivity(stretch) = model.lasting_stretch_scale * from_centre;
      // A rotation vector t of the body moves its point p by t x p.
      sensitivity.segment<3>(kLastingTurn) = model.shape[at(k)].cross(by_origin.row(axis).transpose());
      sensitivity.segment<2>(kAt<KeypointErrors> + row) = root.row(axis).transpose();
      const double linear =
          sensitivity.segment<2>(mount).dot(estimate.mean().segment<2>(mount)) +
          sensitivity.segment<KeypointCommon::kSize>(kAt<KeypointCommon>)
              .dot(estimate.mean().segment<KeypointCommon::kSize>(kAt<KeypointCommon>)) +
          sensitivity.segment<2>(kAt<KeypointErrors> + row).dot(estimate.mean().segment<2>(kAt<KeypointErrors> + row));
      batch.residual(row + axis) = keypoints[at(k)].pixel(axis) - predicted(row + axis) - linear;
    }
    batch.noise.block<2, 2>(row, row) += (1.0 - share) * covariance;
  }
  return true;
}

}  // namespace

bool is_usable(const pose::Keypoint& keypoint) {
  const Matrix2& c = keypoint.covariance_px2;
  return keypoint.is_usable && math::is_finite(keypoint.pixel.sum()) && math::is_finite(c.sum()) && c(0, 0) > 0.0 &&
         c(0, 0) * c(1, 1) - c(1, 0) * c(1, 0) > 0.0;
}

Status keypoint_rows(const filter::RelativeNavigationFilter& filter, const pose::Keypoints& keypoints,
                     const CameraPose& camera, const KeypointModel& model, filter::MeasurementBatch& batch) {
  const auto chief = orbit::qns_from_cartesian(filter.servicer());
  if (!chief.ok()) return chief.status();
  if (!filter.has_attitude()) return Status::kNotReady;
  Transform transform;
  if (const Status status = start(transform, filter.estimate()); status != Status::kOk) return status;
  batch.clear(kRows);
  for (int k = 0; k < kCount; ++k) {
    batch.is_used[at(2 * k)] = batch.is_used[at(2 * k + 1)] = is_usable(keypoints[at(k)]);
  }
  const Vector3 origin = filter.estimate().mean().segment<3>(kAt<KeypointOrigin>);
  std::array<Pixels, Transform::kPoints> values;
  Seen mean;
  for (std::size_t point = 0; point < Transform::kPoints; ++point) {
    const auto seen = pose_of(transform.point(point), filter, chief.value(), camera);
    if (!seen.ok()) return seen.status();
    if (point == 0) mean = seen.value();
    values[point].setZero();
    for (int k = 0; k < kCount; ++k) {
      if (!batch.is_used[at(2 * k)]) continue;
      const auto pixel = imaging::pixel_of(
          model.optics, seen.value().centre_camera + seen.value().R_camera_body * (model.shape[at(k)] + origin));
      if (pixel.ok()) {
        values[point].segment<2>(2 * k) = pixel.value();
      } else {
        batch.is_used[at(2 * k)] = batch.is_used[at(2 * k + 1)] = false;
      }
    }
  }
  const auto regression = transform.regress<kRows>(values);
  for (int r = 0; r < kRows; ++r) {
    if (!batch.is_used[at(r)]) continue;
    for (int j = 0; j < kSampled; ++j) batch.sensitivity(sampled_index(j), r) = regression.jacobian(r, j);
  }
  batch.noise.topLeftCorner<kRows, kRows>() = regression.nonlinearity;
  return add_linear_states(filter, keypoints, camera, model, mean, regression.mean, batch) ? Status::kOk
                                                                                           : Status::kOutOfRange;
}

Status position_rows(const filter::RelativeNavigationFilter& filter, const Vector3& relative_eci,
                     const Matrix3& covariance_m2, filter::MeasurementBatch& batch) {
  using Places = estimation::UnscentedTransform<filter::Roe::kSize>;
  const orbit::CartesianState servicer = filter.servicer();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  Places transform;
  if (const Status status = transform.start(filter.roe(), filter.roe_covariance()); status != Status::kOk)
    return status;
  std::array<Vector3, Places::kPoints> values;
  for (std::size_t k = 0; k < Places::kPoints; ++k) {
    const auto target = orbit::target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    values[k] = target.value().position_eci - servicer.position_eci;
  }
  const auto regression = transform.regress<3>(values);
  batch.clear(3);
  for (int axis = 0; axis < 3; ++axis) {
    batch.sensitivity.col(axis).head<6>() = regression.jacobian.row(axis).transpose();
  }
  batch.residual.head<3>() = relative_eci - regression.mean;
  batch.noise.topLeftCorner<3, 3>() = covariance_m2 + regression.nonlinearity;
  return Status::kOk;
}

}  // namespace vbar::fsw::measurements
