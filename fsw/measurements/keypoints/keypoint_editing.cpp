#include "fsw/measurements/keypoints/keypoint_editing.h"

#include <algorithm>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::measurements {
namespace {

using filter::kAt;

constexpr int kCount = pose::kKeypoints;

// Innovations of images further apart than this are not neighbours.
constexpr Duration kNeighbours = duration_of_seconds(20);

constexpr std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

/// 99 % of chi-square with k degrees of freedom (Wilson, Hilferty 1931), good to a percent from two on.
double max_expected(int k) {
  const double spread = 2.0 / (9.0 * k);
  const double root = 1.0 - spread + 2.3263 * math::sqrt(spread);
  return k * root * root * root;
}

}  // namespace

const KeypointsUpdate& KeypointEditing::process_measurement(filter::RelativeNavigationFilter& filter, GpsTime time,
                                                            const pose::Keypoints& keypoints, const CameraPose& camera,
                                                            const KeypointModel& model, double novelty_scale) {
  update_ = {};
  scaled_ = keypoints;
  // Against an orbit that receivers determine, the innovations are errors of the network, which are tested with its own
  // covariances; a view that was seen before then only loses weight.
  const double tested_scale = filter.is_precisely_determined() ? 1.0 : novelty_scale;
  for (pose::Keypoint& keypoint : scaled_) keypoint.covariance_px2 *= adapted_scale() * tested_scale;
  filter::MeasurementBatch& batch = filter.workspace();
  if (keypoint_rows(filter, scaled_, camera, model, batch) != Status::kOk) return update_;
  estimation::predict_innovations(filter.estimate(), batch);
  gate_keypoints(batch);
  const double nis = estimation::joint_nis(batch);
  const bool is_rejected = update_.used < settings_.min_keypoints ||
                           update_.is_mostly_rejected(settings_.max_rejected_share) || !(nis < estimation::kNoGate);
  if (is_rejected) {
    filter.attitude().noise().interrupt();
    filter.relative_orbit().noise().interrupt();
    return update_;
  }
  update_.nis = nis;
  const int degrees = 2 * update_.used;
  const double misfit = nis > max_expected(degrees) ? std::min(nis / degrees, settings_.max_noise_scale) : 1.0;
  update_.noise_scale = misfit * adapted_scale() * novelty_scale;
  adapt_noise(batch, time, camera, filter);
  weight_keypoints(batch, misfit * (novelty_scale / tested_scale));
  if (!filter.update(kSource, batch)) return update_;
  for (int k = 0; k < kCount; ++k) update_.keypoints[at(k)].postfit = batch.residual.segment<2>(2 * k);
  adapt_scale();
  update_.accepted = true;
  return update_;
}

void KeypointEditing::gate_keypoints(filter::MeasurementBatch& batch) {
  for (int k = 0; k < kCount; ++k) {
    const int row = 2 * k;
    KeypointUpdate& keypoint = update_.keypoints[at(k)];
    keypoint.is_usable = batch.is_used[at(row)];
    if (!keypoint.is_usable) continue;
    ++update_.usable;
    keypoint.prefit = batch.residual.segment<2>(row);
    keypoint.postfit = keypoint.prefit;
    keypoint.nis = estimation::group_nis(batch, row, 2);
    keypoint.accepted = keypoint.nis <= settings_.gate;
    if (keypoint.accepted) ++update_.used;
    batch.is_used[at(row)] = batch.is_used[at(row + 1)] = keypoint.accepted;
  }
}

/// The covariance of each keypoint is multiplied by `common`, the misfit of the image or more, and by the inverse
/// weight of its own innovation under the Student distribution, (nu + d^2) / (nu + 2), not below one.
void KeypointEditing::weight_keypoints(filter::MeasurementBatch& batch, double common) const {
  for (int k = 0; k < kCount; ++k) {
    const KeypointUpdate& keypoint = update_.keypoints[at(k)];
    if (!keypoint.accepted) continue;
    const double tail = (settings_.tail_degrees + keypoint.nis) / (settings_.tail_degrees + 2.0);
    const double scale = common * (tail > 1.0 ? tail : 1.0);
    batch.noise.block<2, 2>(2 * k, 2 * k) += (scale - 1.0) * scaled_[at(k)].covariance_px2;
  }
}

/// The covariances of a network are often too small. They are adapted slowly, by a tenth of a misfit in ten images, so
/// that no single image dominates; never below those given. Gated samples have 0.95 of the expected value.
void KeypointEditing::adapt_scale() {
  constexpr double kShare = 0.02;
  constexpr double kBehindTheGate = 0.953;
  constexpr double kMinScale = 0.8;  // lower bound of the memory; the factor applied is never less than one
  const double ratio = std::clamp(update_.nis / (kBehindTheGate * 2.0 * update_.used), 0.25, 4.0);
  adapted_scale_ = std::clamp(adapted_scale_ * (1.0 + kShare * (ratio - 1.0)), kMinScale, settings_.max_noise_scale);
}

/// By least squares the innovations are a common shift (a lag of the orbit) and a rotation (a lag of the attitude),
/// each normalised by its standard deviation. Two axes of the camera are used for the rotation: across and along it.
void KeypointEditing::adapt_noise(const filter::MeasurementBatch& batch, GpsTime time, const CameraPose& camera,
                                  filter::RelativeNavigationFilter& filter) {
  constexpr int kFitted = 5;
  constexpr int kMinKeypoints = 5;
  filter::AdaptiveNoise& acceleration = filter.relative_orbit().noise();
  filter::AdaptiveNoise& angular = filter.attitude().noise();
  if (update_.used < kMinKeypoints || time - last_processed_ > kNeighbours) {
    acceleration.interrupt();
    angular.interrupt();
  }
  last_processed_ = time;
  if (update_.used < kMinKeypoints) return;
  const Matrix3 R_body_camera =
      (camera.R_camera_eci * filter.attitude().state().q_eci_body.toRotationMatrix()).transpose();
  Eigen::Matrix<double, kMaxMeasurements, kFitted> jacobian = Eigen::Matrix<double, kMaxMeasurements, kFitted>::Zero();
  for (int row = 0; row < batch.count(); ++row) {
    if (!batch.is_used[at(row)]) continue;
    jacobian(row, row % 2) = 1.0;
    // A rotation of 0.01 rad is of the order of a pixel.
    for (int axis = 0; axis < 3; ++axis) {
      jacobian(row, 2 + axis) =
          0.01 * batch.sensitivity.col(row).segment<3>(kAt<filter::AttitudeError>).dot(R_body_camera.col(axis));
    }
  }
  Eigen::Matrix<double, kFitted, kFitted> normal;
  Eigen::Matrix<double, kFitted, 1> right;
  for (int i = 0; i < kFitted; ++i) {
    right(i) = jacobian.col(i).dot(batch.residual);
    for (int j = 0; j < kFitted; ++j) normal(i, j) = jacobian.col(i).dot(jacobian.col(j));
  }
  const math::Cholesky<kFitted> factor(normal);
  if (!factor.ok()) return;
  const Eigen::Matrix<double, kFitted, 1> fitted = factor.solve(right);
  Eigen::Matrix<double, kFitted, 1> normalised;
  for (int i = 0; i < kFitted; ++i) {
    const Eigen::Matrix<double, kFitted, 1> weights = factor.solve(Eigen::Matrix<double, kFitted, 1>::Unit(i));
    filter::MeasurementBatch::Vector combination = filter::MeasurementBatch::Vector::Zero();
    for (int j = 0; j < kFitted; ++j) combination += weights(j) * jacobian.col(j);
    double variance = 0.0;
    for (int c = 0; c < batch.count(); ++c) variance += combination(c) * combination.dot(batch.innovation.col(c));
    if (!(variance > 0.0)) return;
    normalised(i) = fitted(i) / math::sqrt(variance);
  }
  if (filter.is_precisely_determined()) {
    acceleration.interrupt();
  } else {
    // A network errs alike in neighbouring images.
    acceleration.add(normalised.head<2>(), filter::AdaptiveNoise::Correlation::kOfEitherBySize);
  }
  angular.add({normalised(2), normalised(4)});
}

}  // namespace vbar::fsw::measurements
