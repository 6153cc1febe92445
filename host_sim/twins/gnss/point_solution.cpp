#include "host_sim/twins/gnss/point_solution.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "fsw/gnss/constants.h"

namespace vbar::twins::gnss {
namespace {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

// Range errors that a receiver expects beside the noise of its loops: satellites and ionosphere.
constexpr double kExpectedRangeError_m = 1.5;
constexpr double kExpectedRangeRateError_mps = 0.02;

}  // namespace

std::optional<PointSolution> solve_point(const std::vector<PointResidual>& residuals) {
  if (residuals.size() < 4) return std::nullopt;
  Matrix4 information = Matrix4::Zero();
  Matrix4 rate_information = Matrix4::Zero();
  Vector4 code = Vector4::Zero();
  Vector4 rate = Vector4::Zero();
  for (const PointResidual& residual : residuals) {
    Vector4 row;
    row << -residual.line_of_sight, 1.0;
    const double sigma = std::hypot(residual.code_sigma_m, kExpectedRangeError_m);
    information += row * row.transpose() / (sigma * sigma);
    code += row * residual.code_m / (sigma * sigma);
    rate_information += row * row.transpose() / (kExpectedRangeRateError_mps * kExpectedRangeRateError_mps);
    rate += row * residual.range_rate_mps / (kExpectedRangeRateError_mps * kExpectedRangeRateError_mps);
  }
  const Eigen::LLT<Matrix4> factor(information);
  const Eigen::LLT<Matrix4> rate_factor(rate_information);
  // Weaker geometry would result in errors of kilometres: no receiver reports such a solution.
  if (factor.info() != Eigen::Success || factor.rcond() < 1e-8) return std::nullopt;
  const Vector4 x = factor.solve(code);
  const Vector4 v = rate_factor.solve(rate);
  const Matrix4 covariance = factor.solve(Matrix4::Identity());
  const Matrix4 rate_covariance = rate_factor.solve(Matrix4::Identity());

  PointSolution solution;
  solution.satellites = residuals.size();
  solution.position_error_ecef = x.head<3>();
  solution.velocity_error_ecef = v.head<3>();
  solution.position_sigma = covariance.diagonal().head<3>().cwiseSqrt();
  solution.velocity_sigma = rate_covariance.diagonal().head<3>().cwiseSqrt();
  solution.clock_offset_s = x(3) / fsw::gnss::kSpeedOfLight;
  solution.clock_drift = v(3) / fsw::gnss::kSpeedOfLight;
  solution.clock_sigma_s = std::sqrt(covariance(3, 3)) / fsw::gnss::kSpeedOfLight;
  return solution;
}

}  // namespace vbar::twins::gnss
