#include "host_sim/twins/gnss/point_solution.h"

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Cholesky>

#include "fsw/gnss/constants.h"

namespace vbar::twins::gnss {

CrystalOscillator::CrystalOscillator(const ClockSettings& settings, std::uint64_t seed, std::string_view stream)
    : white_variance_rate_(settings.h0_s / 2.0),
      random_walk_variance_rate_(2.0 * std::numbers::pi * std::numbers::pi * settings.h_minus2_per_s),
      stream_(seed, stream),
      offset_s_(stream_.uniform(-1.0, 1.0) * settings.initial_offset_ms * 1e-3),
      drift_(stream_.normal() * settings.initial_drift_sigma_ns_per_s * 1e-9) {}

void CrystalOscillator::advance(double elapsed_s) {
  const double s_f = white_variance_rate_;
  const double s_g = random_walk_variance_rate_;
  // The offset's S_g t^3/3 consists of t^3/4, which goes along with the drift's step (half of that step times t), and
  // of its own t^3/12.
  const double drift_step = stream_.normal() * std::sqrt(s_g * elapsed_s);
  const double rest_variance = s_f * elapsed_s + s_g * elapsed_s * elapsed_s * elapsed_s / 12.0;
  offset_s_ += (drift_ + drift_step / 2.0) * elapsed_s + stream_.normal() * std::sqrt(rest_variance);
  drift_ += drift_step;
}

ReceiverClock::ReceiverClock(const ClockSettings& settings, std::uint64_t seed, std::string_view receiver)
    : jump_threshold_s_(settings.jump_threshold_ms * 1e-3),
      oscillator_(settings, seed, "gnss/" + std::string(receiver) + "/clock") {}

void ReceiverClock::advance(double elapsed_s) {
  oscillator_.advance(elapsed_s);
  const double offset_s = oscillator_.offset_s();
  if (std::abs(offset_s) <= jump_threshold_s_) return;
  oscillator_.shift(-std::round(offset_s * 1e3) * 1e-3);
  ++jumps_;
}

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
