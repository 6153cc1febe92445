#include "fsw/vision/pose/closed_form_pose.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"
#include "fsw/vision/pose/rotation.h"

namespace vbar::fsw::pose {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Matrix39 = Eigen::Matrix<double, 3, 9>;

constexpr int kStarts = 4;  ///< eigenvectors; three belong to the form's null space if the points lie in a plane
constexpr int kMaxSteps = 20;
constexpr double kSmallestStep = 1e-9;  ///< rad; Newton's next step would be its square
constexpr double kSameRotation = 1e-3;  ///< rad
constexpr double kMinDistance = 0.1;    ///< m, along the boresight

/// r' form r with r the rows of the rotation stacked; the best position is `position` r.
struct QuadraticForm {
  Matrix9 form = Matrix9::Zero();
  Matrix39 position = Matrix39::Zero();
};

Vector9 elements_of(const Matrix3& R) {
  Vector9 r;
  r << R.row(0).transpose(), R.row(1).transpose(), R.row(2).transpose();
  return r;
}

Matrix3 matrix_of(const Vector9& r) {
  Matrix3 R;
  R << r.segment<3>(0).transpose(), r.segment<3>(3).transpose(), r.segment<3>(6).transpose();
  return R;
}

/// Terzakis and Lourakis 2020, equations 4 to 10.
Result<QuadraticForm> form_of(std::span<const SeenPoint> points) {
  Matrix3 sum_q = Matrix3::Zero();
  Matrix39 sum_qa = Matrix39::Zero();
  QuadraticForm f;
  for (const SeenPoint& point : points) {
    Matrix3 q;  // distance of a point from the line of sight, in the image plane times depth
    const double x = point.image.x();
    const double y = point.image.y();
    q << 1.0, 0.0, -x, 0.0, 1.0, -y, -x, -y, x * x + y * y;
    q *= point.weight;
    const Matrix3 square = point.body * point.body.transpose();
    sum_q += q;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        f.form.block<3, 3>(3 * a, 3 * b) += q(a, b) * square;
        sum_qa.block<1, 3>(a, 3 * b) += q(a, b) * point.body.transpose();
      }
    }
  }
  const math::Cholesky<3> cholesky(sum_q);
  // A single line of sight leaves the distance along it undetermined.
  if (!(cholesky.smallest_pivot() > 1e-12 * sum_q.trace())) return Status::kSingular;
  for (int k = 0; k < 9; ++k) f.position.col(k) = -cholesky.solve(sum_qa.col(k));
  f.form += sum_qa.transpose().lazyProduct(f.position);
  return f;
}

double cost_of(const Matrix9& form, const Vector9& r) {
  return r.dot(form.lazyProduct(r));
}

/// Gradient and Hessian of the cost with respect to a rotation about the camera's axes.
struct Slopes {
  Vector3 gradient = Vector3::Zero();
  Matrix3 first_order = Matrix3::Zero();  ///< positive semidefinite part of the Hessian
  Matrix3 curvature = Matrix3::Zero();
};

Slopes slopes_at(const Matrix9& form, const Matrix3& R) {
  Eigen::Matrix<double, 9, 3> tangent;
  for (int k = 0; k < 3; ++k) tangent.col(k) = elements_of(cross_matrix(Vector3::Unit(k)) * R);
  const Vector9 slope = form.lazyProduct(elements_of(R));
  const Matrix3 moment = matrix_of(slope) * R.transpose();
  Slopes s;
  s.gradient << moment(2, 1) - moment(1, 2), moment(0, 2) - moment(2, 0), moment(1, 0) - moment(0, 1);
  const Eigen::Matrix<double, 9, 3> form_tangent = form.lazyProduct(tangent);
  s.first_order = tangent.transpose().lazyProduct(form_tangent);
  s.curvature = s.first_order + 0.5 * (moment + moment.transpose()) - moment.trace() * Matrix3::Identity();
  return s;
}

/// Newton's method, damped where the cost does not decrease.
Matrix3 minimum_from(const Matrix9& form, Matrix3 R) {
  double cost = cost_of(form, elements_of(R));
  double damping = 0.0;
  for (int k = 0; k < kMaxSteps; ++k) {
    const Slopes s = slopes_at(form, R);
    const double scale = s.first_order.trace();
    if (!(scale > 0.0)) return R;
    math::Cholesky<3> cholesky(s.curvature + damping * Matrix3::Identity());
    if (!(cholesky.smallest_pivot() > 1e-9 * scale)) {
      cholesky = math::Cholesky<3>(s.first_order + (damping + 1e-3 * scale) * Matrix3::Identity());
    }
    if (!cholesky.ok()) return R;
    const Vector3 step = -cholesky.solve(s.gradient);
    const Matrix3 next = rotation_by(step) * R;
    const double next_cost = cost_of(form, elements_of(next));
    const bool is_small = step.cwiseAbs().maxCoeff() < kSmallestStep;
    if (next_cost <= cost || is_small) {
      R = next;
      cost = next_cost;
      damping *= 0.1;
      if (is_small) return R;
    } else {
      damping = damping > 1e-2 * scale ? 10.0 * damping : 1e-1 * scale;
    }
  }
  return R;
}

bool is_before_camera(const TargetPose& pose, std::span<const SeenPoint> points) {
  for (const SeenPoint& point : points) {
    const double depth = (pose.R_camera_body * point.body + pose.position_camera_m).z();
    if (!(depth > kMinDistance)) return false;
  }
  return true;
}

/// In the order of costs; duplicates are merged.
void keep(const TargetPose& pose, double cost, ClosedFormPoses& all) {
  for (std::size_t k = 0; k < all.count; ++k) {
    if (angle_between(pose.R_camera_body, all.poses[k].R_camera_body) > kSameRotation) continue;
    return;
  }
  if (all.count == ClosedFormPoses::kMaxPoses && !(cost < all.costs[all.count - 1])) return;
  std::size_t place = all.count < ClosedFormPoses::kMaxPoses ? all.count++ : all.count - 1;
  for (; place > 0 && cost < all.costs[place - 1]; --place) {
    all.poses[place] = all.poses[place - 1];
    all.costs[place] = all.costs[place - 1];
  }
  all.poses[place] = pose;
  all.costs[place] = cost;
}

}  // namespace

ClosedFormPoses closed_form_poses(std::span<const SeenPoint> points) {
  ClosedFormPoses all;
  if (points.size() < 3) return all;
  const Result<QuadraticForm> f = form_of(points);
  if (!f.ok()) return all;
  const Result<math::SymmetricEigen<9>> eigen = math::symmetric_eigen<9>(f.value().form);
  if (!eigen.ok()) return all;
  for (int k = 0; k < 2 * kStarts; ++k) {
    const Vector9 direction = (k % 2 == 0 ? 1.0 : -1.0) * eigen.value().vectors.col(k / 2);
    const Result<Matrix3> start = nearest_rotation(matrix_of(direction));
    if (!start.ok()) continue;
    TargetPose pose;
    pose.R_camera_body = minimum_from(f.value().form, start.value());
    const Vector9 r = elements_of(pose.R_camera_body);
    pose.position_camera_m = f.value().position.lazyProduct(r);
    if (is_before_camera(pose, points)) keep(pose, cost_of(f.value().form, r), all);
  }
  return all;
}

}  // namespace vbar::fsw::pose
