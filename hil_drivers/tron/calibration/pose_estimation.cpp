#include "hil_drivers/tron/calibration/pose_estimation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tron::calibrate {

namespace {

using Eigen::Matrix3d;
using fsw::Vector3;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kFreedoms = 5.0;

Matrix3d cross_matrix(const Vector3& v) {
  Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// Below these no arm and no motion capture is: repeatability.
double least_of(double Scatter::*member) {
  return member == &Scatter::place_m ? 5e-5 : 3e-5;
}

double minus_log_likelihood(const std::vector<ScatterSample>& samples, const Scatter& scatter) {
  double sum = 0.0;
  for (const ScatterSample& sample : samples) {
    const Eigen::LLT<Matrix6> llt(sample.known_covariance + scatter_covariance(scatter, sample.T_C_T));
    if (llt.info() != Eigen::Success) return 1e300;
    const double square = sample.difference.dot(llt.solve(sample.difference));
    double log_root = 0.0;
    const Matrix6 root = llt.matrixL();
    for (int k = 0; k < 6; ++k) log_root += std::log(root(k, k));
    // Scaled so that the covariance is that of the distribution's core.
    sum += log_root + 0.5 * (kFreedoms + 6.0) * std::log1p(square / kFreedoms);
  }
  return sum;
}

}  // namespace

Matrix6 scatter_covariance(const Scatter& scatter, const Eigen::Isometry3d& T_C_T) {
  // A camera turned by a small vector r and moved by p sees the rotation -r and the translation t x r - p.
  const double rotation = scatter.camera_rad * scatter.camera_rad;
  const double place = scatter.place_m * scatter.place_m;
  const Matrix3d cross = cross_matrix(T_C_T.translation());
  Matrix6 covariance = Matrix6::Zero();
  covariance.topLeftCorner<3, 3>() = (rotation + scatter.target_rad * scatter.target_rad) * Matrix3d::Identity();
  covariance.bottomRightCorner<3, 3>() = rotation * cross * cross.transpose() + 2.0 * place * Matrix3d::Identity();
  covariance.topRightCorner<3, 3>() = -rotation * cross.transpose();
  covariance.bottomLeftCorner<3, 3>() = -rotation * cross;
  return covariance;
}

Vector6 pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::AngleAxisd turn(Matrix3d(to.linear() * from.linear().transpose()));
  Vector6 difference;
  difference << turn.angle() * turn.axis(), to.translation() - from.translation();
  return difference;
}

Scatter estimate_scatter(const std::vector<ScatterSample>& samples, const Scatter& start) {
  Scatter best = start;
  double cost = minus_log_likelihood(samples, best);
  // Search along each of the three in turn, in ratios, which halve.
  const auto improve = [&](double Scatter::*member, double ratio) {
    bool has_improved = false;
    for (const double factor : {ratio, 1.0 / ratio})
      for (int k = 0; k < 20; ++k) {
        Scatter trial = best;
        trial.*member *= factor;
        if (trial.*member < least_of(member) || trial.*member > 0.1) break;
        const double next = minus_log_likelihood(samples, trial);
        if (!(next < cost)) break;
        best = trial;
        cost = next;
        has_improved = true;
      }
    return has_improved;
  };
  for (double ratio = 2.0; ratio > 1.02; ratio = std::sqrt(ratio))
    for (int k = 0; k < 6; ++k) {
      const bool a = improve(&Scatter::camera_rad, ratio), b = improve(&Scatter::target_rad, ratio),
                 c = improve(&Scatter::place_m, ratio);
      if (!a && !b && !c) break;
    }
  return best;
}

namespace {

using fsw::Vector2;

constexpr int kIterations = 60;
constexpr double kHuber = 2.5;  ///< in sigmas

/// Derivative of the pixel by the point in camera axes, by central differences of the lens (its terms are smooth over
/// the step of 1e-5 of the depth).
Eigen::Matrix<double, 2, 3> lens_jacobian(const LensCalibration& lens, const Vector3& point) {
  Eigen::Matrix<double, 2, 3> jacobian;
  const double step = 1e-5 * point.z();
  for (int k = 0; k < 3; ++k) {
    const Vector3 offset = step * Vector3::Unit(k);
    jacobian.col(k) = (lens.project(point + offset) - lens.project(point - offset)) / (2.0 * step);
  }
  return jacobian;
}

struct Normal {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  double cost = 0.0, square = 0.0, weight = 0.0;
};

std::optional<Normal> normal_equations(const BoardDesign& board, const LensCalibration& lens,
                                       const std::vector<Corner>& corners, const Eigen::Isometry3d& T, double sigma) {
  Normal normal;
  for (const Corner& corner : corners) {
    const Vector3 turned = T.linear() * board.corner(corner.id);
    const Vector3 point = turned + T.translation();
    if (!(point.z() > 0.05)) return std::nullopt;
    const Vector2 residual = corner.px - lens.project(point);
    const double size = residual.norm() / sigma;
    const double weight = size <= kHuber ? 1.0 : kHuber / size;
    const Eigen::Matrix<double, 2, 3> by_point = lens_jacobian(lens, point);
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << 0.0, turned.z(), -turned.y(), 1.0, 0.0, 0.0,  //
        -turned.z(), 0.0, turned.x(), 0.0, 1.0, 0.0,         //
        turned.y(), -turned.x(), 0.0, 0.0, 0.0, 1.0;
    const Eigen::Matrix<double, 2, 6> jacobian = by_point * by_pose;
    normal.matrix += weight * jacobian.transpose() * jacobian;
    normal.right += weight * jacobian.transpose() * residual;
    normal.cost += size <= kHuber ? size * size : kHuber * (2.0 * size - kHuber);
    normal.square += weight * residual.squaredNorm();
    normal.weight += 2.0 * weight;
  }
  return normal;
}

Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Vector6& step) {
  Eigen::Isometry3d result = T;
  result.linear() = rotation_of<double>(step.head<3>()) * T.linear();
  result.translation() += step.tail<3>();
  return result;
}

/// Levenberg-Marquardt with residuals weighted for `sigma`.
bool minimise(const BoardDesign& board, const LensCalibration& lens, const std::vector<Corner>& corners, double sigma,
              Eigen::Isometry3d& T, Normal& normal) {
  auto current = normal_equations(board, lens, corners, T, sigma);
  if (!current) return false;
  double damping = 1e-3;
  for (int k = 0; k < kIterations; ++k) {
    Matrix6 damped = current->matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 step = damped.ldlt().solve(current->right);
    if (!step.allFinite()) return false;
    const Eigen::Isometry3d trial = moved(T, step);
    const auto next = normal_equations(board, lens, corners, trial, sigma);
    if (next && next->cost <= current->cost) {
      T = trial;
      const bool is_done = step.norm() < 1e-10;
      current = next;
      damping = std::max(damping * 0.2, 1e-12);
      if (is_done) break;
    } else {
      damping *= 8.0;
      if (damping > 1e10) break;
    }
  }
  normal = *current;
  return true;
}

/// The plane's tilt reversed about the line of sight, its turn about it kept: its normal rotated past the line of sight
/// by the angle between both, the quaternion (n.s, n x s).
Eigen::Isometry3d with_tilt_reversed(const Eigen::Isometry3d& T) {
  const Vector3 sight = T.translation().normalized();
  const Vector3 normal = T.linear().col(2);
  const Vector3 axis = normal.cross(sight);
  const Eigen::Quaterniond turn(normal.dot(sight), axis.x(), axis.y(), axis.z());
  Eigen::Isometry3d result = T;
  result.linear() = turn.toRotationMatrix() * T.linear();
  return result;
}

}  // namespace

std::optional<BoardPose> refine_board_pose(const BoardDesign& board, const LensCalibration& lens,
                                           const std::vector<Corner>& corners, const Eigen::Isometry3d& start) {
  if (static_cast<int>(corners.size()) < kMinCorners) return std::nullopt;
  BoardPose pose;
  pose.T_C_B = start;
  Normal normal;
  // First with a wide loss, then with that of the residuals found.
  if (!minimise(board, lens, corners, 100.0, pose.T_C_B, normal)) return std::nullopt;
  double sigma = std::max(kCornerSigma_px, std::sqrt(normal.square / normal.weight));
  for (int k = 0; k < 3; ++k) {
    if (!minimise(board, lens, corners, sigma, pose.T_C_B, normal)) return std::nullopt;
    const double freedoms = std::max(1.0, normal.weight - 6.0);
    pose.rms_px = std::sqrt(normal.square / freedoms);
    sigma = std::max(kCornerSigma_px, pose.rms_px);
  }
  pose.sigma_px = sigma;
  const Eigen::LDLT<Matrix6> decomposition(normal.matrix);
  if (decomposition.info() != Eigen::Success || !decomposition.isPositive()) return std::nullopt;
  pose.covariance = sigma * sigma * decomposition.solve(Matrix6::Identity());
  if (!pose.covariance.allFinite() || !pose.T_C_B.matrix().allFinite()) return std::nullopt;
  return pose;
}

std::optional<BoardPose> board_pose(const BoardDesign& board, const LensCalibration& lens,
                                    const std::vector<Corner>& corners, const Eigen::Isometry3d& start) {
  const auto first = refine_board_pose(board, lens, corners, start);
  const auto second = refine_board_pose(board, lens, corners, with_tilt_reversed(first ? first->T_C_B : start));
  if (!first) return second;
  if (!second || first->rms_px <= second->rms_px) return first;
  return second;
}

}  // namespace vbar::tron::calibrate
