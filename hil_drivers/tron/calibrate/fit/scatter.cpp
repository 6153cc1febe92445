#include "hil_drivers/tron/calibrate/fit/scatter.h"

#include <cmath>

#include <Eigen/Cholesky>

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

}  // namespace vbar::tron::calibrate
