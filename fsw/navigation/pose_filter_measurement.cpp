// Measurement update of the pose filter with keypoints: prediction, editing, update.

#include <algorithm>

#include "fsw/estimation/unscented.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/navigation/pose_filter.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::navigation {
namespace {

using Filter = PoseFilter;
using Transform = estimation::UnscentedTransform<9>;  // ROE and rotation

constexpr int kRotation = Filter::State::offset<Filter::Attitude>();
constexpr int kCommon = Filter::State::offset<Filter::Common>();
constexpr int kErrors = Filter::State::offset<Filter::KeypointError>();
constexpr double kNoGate = 1e300;

// Innovations of images further apart than this are not neighbours.
constexpr double kNeighbours_s = 20.0;

// Points at 1.8 standard deviations; the central point's weight in a covariance stays above zero.
constexpr estimation::UnscentedParameters kPoints = {.alpha = 0.6, .beta = 2.0, .kappa = 0.0};

constexpr double square(double x) {
  return x * x;
}

constexpr std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

/// 99 % of chi-square with k degrees of freedom (Wilson, Hilferty 1931), good to a percent from two on.
double max_expected(int k) {
  const double spread = 2.0 / (9.0 * k);
  const double root = 1.0 - spread + 2.3263 * math::sqrt(spread);
  return k * root * root * root;
}

bool is_usable(const pose::Keypoint& keypoint) {
  const Matrix2& c = keypoint.covariance_px2;
  return keypoint.is_usable && math::is_finite(keypoint.pixel.sum()) && math::is_finite(c.sum()) && c(0, 0) > 0.0 &&
         c(0, 0) * c(1, 1) - c(1, 0) * c(1, 0) > 0.0;
}

/// Cholesky factor, lower.
Matrix2 root_of(const Matrix2& covariance) {
  const double a = math::sqrt(covariance(0, 0));
  const double b = covariance(1, 0) / a;
  Matrix2 root;
  root << a, 0.0, b, math::sqrt(covariance(1, 1) - b * b);
  return root;
}

double nis_of(const Matrix2& s, const Vector2& r) {
  const double determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
  if (!(determinant > 0.0)) return kNoGate;
  return (s(1, 1) * r(0) * r(0) - 2.0 * s(0, 1) * r(0) * r(1) + s(0, 0) * r(1) * r(1)) / determinant;
}

}  // namespace

const PoseUpdate& PoseFilter::take(const pose::Keypoints& keypoints, const CameraPose& camera,
                                   const orbit::CartesianState& servicer) {
  update_ = {};
  if (!started_) return update_;
  if (!predict_keypoints(keypoints, camera, servicer)) return update_;
  expect_innovations();
  gate_keypoints();
  if (update_.used < settings_.min_keypoints || update_.is_mostly_rejected(settings_.max_refused_share)) {
    angular_noise_.interrupt();
    acceleration_noise_.interrupt();
    return update_;
  }
  std::array<int, kRows> rows{};
  int count = 0;
  for (int row = 0; row < kRows; ++row) {
    if (update_.keypoints[at(row / 2)].accepted) rows[at(count++)] = row;
  }
  update_.nis = joint_nis(rows, count);
  const bool is_misfit = update_.nis > max_expected(count);
  const double raised = is_misfit ? std::min(update_.nis / count, settings_.max_noise_scale) : 1.0;
  update_.noise_scale = raised * learned_noise_scale();
  adapt(rows, count, camera);
  since_update_s_ = 0.0;
  fold_in(keypoints, raised);
  learn_scale(count);
  update_.accepted = true;
  if (!estimate_.is_sound()) reset();
  return update_;
}

/// Mean, Jacobian and nonlinearity of the pixels of all keypoints, by sigma points of ROE and rotation. A keypoint that
/// is behind the camera for one of them is not used.
bool PoseFilter::predict_keypoints(const pose::Keypoints& keypoints, const CameraPose& camera,
                                   const orbit::CartesianState& servicer) {
  Transform transform;
  const auto chief = orbit::qns_from_cartesian(servicer);
  const Eigen::Matrix<double, 9, 1> mean = estimate_.mean().head<9>();
  if (!chief.ok() || transform.start(mean, estimate_.head_covariance<9>(), kPoints) != Status::kOk) return false;
  for (std::size_t k = 0; k < pose::Keypoints{}.size(); ++k) {
    update_.keypoints[k].is_usable = is_usable(keypoints[k]);
  }
  Vector2 centre_px = settings_.camera.principal_point_px;
  for (std::size_t point = 0; point < Transform::kPoints; ++point) {
    const Eigen::Matrix<double, 9, 1> x = transform.point(point);
    const auto target = target_from_roe(chief.value(), x.head<6>());
    if (!target.ok()) return false;
    const Vector3 centre_camera =
        camera.R_camera_eci * (target.value().position_eci - servicer.position_eci - camera.origin_eci);
    const Matrix3 R_camera_body =
        camera.R_camera_eci * (attitude_.q_eci_body * quaternion_of_grp(x.segment<3>(kRotation))).toRotationMatrix();
    work_.values[point].setZero();
    for (std::size_t k = 0; k < settings_.shape.size(); ++k) {
      if (!update_.keypoints[k].is_usable) continue;
      const auto pixel = imaging::pixel_of(settings_.camera, centre_camera + R_camera_body * settings_.shape[k]);
      if (!pixel.ok()) {
        update_.keypoints[k].is_usable = false;
      } else {
        work_.values[point].segment<2>(2 * static_cast<int>(k)) = pixel.value();
      }
    }
    if (point == 0) {
      const auto centre = imaging::pixel_of(settings_.camera, centre_camera);
      if (!centre.ok()) return false;
      centre_px = centre.value();
    }
  }
  const auto regression = transform.regress<kRows>(work_.values);
  work_.predicted = regression.mean;
  work_.noise = regression.nonlinearity;
  work_.jacobian.setZero();
  work_.jacobian.leftCols<kSeen>() = regression.jacobian;
  model_errors(keypoints, centre_px);
  return true;
}

/// The correlated part of a keypoint's error is a state in units of the root of its covariance; the rest is noise.
void PoseFilter::model_errors(const pose::Keypoints& keypoints, const Vector2& centre_px) {
  const double lasting = math::sqrt(settings_.correlated_share);
  work_.residual.setZero();
  for (int k = 0; k < network::kKeypoints; ++k) {
    if (!update_.keypoints[at(k)].is_usable) continue;
    ++update_.usable;
    const int row = 2 * k;
    const Matrix2 covariance = learned_noise_scale() * keypoints[at(k)].covariance_px2;
    work_.jacobian.block<2, 2>(row, kErrors + row) = lasting * root_of(covariance);
    work_.jacobian.block<2, 2>(row, kCommon) = Matrix2::Identity();
    work_.jacobian.block<2, 1>(row, kCommon + 2) = work_.predicted.segment<2>(row) - centre_px;
    work_.jacobian.block<2, 1>(row, kCommon + 3) = work_.jacobian.block<2, 1>(row, kCommon + 2);
    work_.noise.block<2, 2>(row, row) += (1.0 - settings_.correlated_share) * covariance;
    const Vector2 errors =
        work_.jacobian.block<2, Common::kSize>(row, kCommon) * estimate_.mean().segment<Common::kSize>(kCommon) +
        work_.jacobian.block<2, 2>(row, kErrors + row) * estimate_.mean().segment<2>(kErrors + row);
    work_.residual.segment<2>(row) = keypoints[at(k)].pixel - work_.predicted.segment<2>(row) - errors;
    update_.keypoints[at(k)].prefit = work_.residual.segment<2>(row);
    update_.keypoints[at(k)].postfit = work_.residual.segment<2>(row);
  }
}

/// S = H P H' + N of all rows.
void PoseFilter::expect_innovations() {
  work_.jacobian_covariance.setZero();
  for (int j = 0; j < State::kSize; ++j) {
    for (int i = 0; i < State::kSize; ++i) {
      const double p = estimate_.covariance(j, i);
      if (p != 0.0) work_.jacobian_covariance.col(i) += p * work_.jacobian.col(j);
    }
  }
  work_.innovation = work_.noise;
  for (int i = 0; i < State::kSize; ++i) {
    for (int c = 0; c < kRows; ++c) {
      const double h = work_.jacobian(c, i);
      if (h != 0.0) work_.innovation.col(c) += h * work_.jacobian_covariance.col(i);
    }
  }
}

void PoseFilter::gate_keypoints() {
  for (int k = 0; k < network::kKeypoints; ++k) {
    KeypointUpdate& keypoint = update_.keypoints[at(k)];
    if (!keypoint.is_usable) continue;
    keypoint.nis = nis_of(work_.innovation.block<2, 2>(2 * k, 2 * k), keypoint.prefit);
    keypoint.accepted = keypoint.nis <= settings_.gate;
    if (keypoint.accepted) ++update_.used;
  }
}

/// Lower Cholesky factor of the first `count` of `rows`, into the workspace.
bool PoseFilter::factorise(const Square& matrix, const std::array<int, kRows>& rows, int count) {
  for (int c = 0; c < count; ++c) {
    double pivot = matrix(rows[at(c)], rows[at(c)]);
    for (int k = 0; k < c; ++k) pivot -= square(work_.lower(c, k));
    if (!(pivot > 0.0) || !math::is_finite(pivot)) return false;
    work_.lower(c, c) = math::sqrt(pivot);
    for (int r = c + 1; r < count; ++r) {
      double sum = matrix(rows[at(r)], rows[at(c)]);
      for (int k = 0; k < c; ++k) sum -= work_.lower(r, k) * work_.lower(c, k);
      work_.lower(r, c) = sum / work_.lower(c, c);
    }
  }
  return true;
}

double PoseFilter::joint_nis(const std::array<int, kRows>& rows, int count) {
  if (!factorise(work_.innovation, rows, count)) return 0.0;
  Rows whitened = Rows::Zero();
  double sum = 0.0;
  for (int r = 0; r < count; ++r) {
    double value = work_.residual(rows[at(r)]);
    for (int k = 0; k < r; ++k) value -= work_.lower(r, k) * whitened(k);
    whitened(r) = value / work_.lower(r, r);
    sum += square(whitened(r));
  }
  return sum;
}

/// The accepted rows are decorrelated, then processed one by one.
void PoseFilter::fold_in(const pose::Keypoints& keypoints, double raised) {
  std::array<int, kRows> rows{};
  int count = 0;
  for (int k = 0; k < network::kKeypoints; ++k) {
    if (!update_.keypoints[at(k)].accepted) continue;
    rows[at(count++)] = 2 * k;
    rows[at(count++)] = 2 * k + 1;
    work_.noise.block<2, 2>(2 * k, 2 * k) += (raised - 1.0) * learned_noise_scale() * keypoints[at(k)].covariance_px2;
  }
  if (!factorise(work_.noise, rows, count)) return;
  const Estimate::Vector old = estimate_.mean();
  // Rows of L^-1 H, and of L^-1 r, overwrite those no longer needed.
  for (int r = 0; r < count; ++r) {
    Estimate::Vector h = work_.jacobian.row(rows[at(r)]).transpose();
    double value = work_.residual(rows[at(r)]);
    for (int k = 0; k < r; ++k) {
      h -= work_.lower(r, k) * work_.jacobian_covariance.row(k).transpose();
      value -= work_.lower(r, k) * work_.values[0](k);
    }
    h /= work_.lower(r, r);
    value /= work_.lower(r, r);
    work_.jacobian_covariance.row(r) = h.transpose();
    work_.values[0](r) = value;
    estimate_.update(h, value - h.dot(estimate_.mean() - old), 1.0, kNoGate);
  }
  const Estimate::Vector change = estimate_.mean() - old;
  for (int k = 0; k < network::kKeypoints; ++k) {
    KeypointUpdate& keypoint = update_.keypoints[at(k)];
    for (int axis = 0; axis < 2; ++axis) {
      keypoint.postfit(axis) = keypoint.prefit(axis) - work_.jacobian.row(2 * k + axis).transpose().dot(change);
    }
  }
  reset_attitude_error();
}

/// The covariances of a network are often too small. They are adapted slowly, by a tenth of a misfit in ten images, so
/// that no single image dominates; never below those given. Gated samples have 0.95 of the expected value.
void PoseFilter::learn_scale(int count) {
  constexpr double kShare = 0.02;
  constexpr double kBehindTheGate = 0.953;
  constexpr double kMinScale = 0.8;  // lower bound of the memory; the factor applied is never less than one
  const double ratio = std::clamp(update_.nis / (kBehindTheGate * count), 0.25, 4.0);
  learned_scale_ = std::clamp(learned_scale_ * (1.0 + kShare * (ratio - 1.0)), kMinScale, settings_.max_noise_scale);
}

/// By least squares the innovations are a common shift (a lag of the orbit) and a rotation (a lag of the attitude),
/// each normalised by its standard deviation. Two axes of the camera are used for the rotation: across and along it.
void PoseFilter::adapt(const std::array<int, kRows>& rows, int count, const CameraPose& camera) {
  constexpr int kFitted = 5;
  constexpr int kMinRows = 10;
  if (count < kMinRows || since_update_s_ > kNeighbours_s) {
    acceleration_noise_.interrupt();
    angular_noise_.interrupt();
  }
  if (count < kMinRows) return;
  const Matrix3 R_body_camera = (camera.R_camera_eci * attitude_.q_eci_body.toRotationMatrix()).transpose();
  Eigen::Matrix<double, kRows, kFitted> jacobian = Eigen::Matrix<double, kRows, kFitted>::Zero();
  for (int r = 0; r < count; ++r) {
    const int row = rows[at(r)];
    jacobian(row, row % 2) = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int j = 0; j < 3; ++j)
        jacobian(row, 2 + axis) += work_.jacobian(row, kRotation + j) * R_body_camera(j, axis);
    }
  }
  // Scales a rotation of 0.01 rad to the order of a pixel.
  jacobian.rightCols<3>() *= 0.01;
  Eigen::Matrix<double, kFitted, kFitted> normal;
  Eigen::Matrix<double, kFitted, 1> right;
  for (int i = 0; i < kFitted; ++i) {
    right(i) = jacobian.col(i).dot(work_.residual);
    for (int j = 0; j < kFitted; ++j) normal(i, j) = jacobian.col(i).dot(jacobian.col(j));
  }
  const math::Cholesky<kFitted> factor(normal);
  if (!factor.ok()) return;
  const Eigen::Matrix<double, kFitted, 1> fitted = factor.solve(right);
  Eigen::Matrix<double, kFitted, 1> normalised;
  for (int i = 0; i < kFitted; ++i) {
    const Eigen::Matrix<double, kFitted, 1> weights = factor.solve(Eigen::Matrix<double, kFitted, 1>::Unit(i));
    Rows combination = Rows::Zero();
    for (int j = 0; j < kFitted; ++j) combination += weights(j) * jacobian.col(j);
    double variance = 0.0;
    for (int c = 0; c < kRows; ++c) variance += combination(c) * combination.dot(work_.innovation.col(c));
    if (!(variance > 0.0)) return;
    normalised(i) = fitted(i) / math::sqrt(variance);
  }
  acceleration_noise_.take(normalised.head<2>());
  angular_noise_.take({normalised(2), normalised(4)});
}

void PoseFilter::take_position(const Vector3& relative_eci, const Matrix3& covariance_m2,
                               const orbit::CartesianState& servicer) {
  using Places = estimation::UnscentedTransform<6>;
  if (!started_) return;
  Places transform;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || transform.start(roe(), roe_covariance()) != Status::kOk) return;
  std::array<Vector3, Places::kPoints> values;
  for (std::size_t k = 0; k < Places::kPoints; ++k) {
    const auto target = target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return;
    values[k] = target.value().position_eci - servicer.position_eci;
  }
  const auto regression = transform.regress<3>(values);
  const math::Cholesky<3> noise(covariance_m2 + regression.nonlinearity);
  if (!noise.ok()) return;
  const Vector3 residual = noise.solve_lower(relative_eci - regression.mean);
  Eigen::Matrix<double, 3, 6> whitened;
  for (int c = 0; c < 6; ++c) whitened.col(c) = noise.solve_lower(regression.jacobian.col(c));
  const Estimate::Vector old = estimate_.mean();
  for (int r = 0; r < 3; ++r) {
    Estimate::Vector h = Estimate::Vector::Zero();
    h.head<6>() = whitened.row(r).transpose();
    estimate_.update(h, residual(r) - h.dot(estimate_.mean() - old), 1.0, kNoGate);
  }
  reset_attitude_error();
  if (!estimate_.is_sound()) reset();
}

}  // namespace vbar::fsw::navigation
