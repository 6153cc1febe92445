#include "host_sim/flown_gnss/orbit_errors.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "fsw/gnss/constants.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/rtn.h"

namespace vbar::flown_gnss {

using fsw::Matrix3;
using fsw::Vector3;

namespace {

double mean_of(double sum, std::size_t count) {
  return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

}  // namespace

void ErrorSums::add(const ErrorSums& other) {
  epochs += other.epochs;
  points += other.points;
  point_squares_m2 += other.point_squares_m2;
  rtn_m += other.rtn_m;
  rtn_squares_m2 += other.rtn_squares_m2;
  nees += other.nees;
  nis += other.nis;
}

double ErrorSums::rms_m() const {
  return std::sqrt(mean_of(rtn_squares_m2.sum(), epochs));
}
double ErrorSums::point_rms_m() const {
  return std::sqrt(mean_of(point_squares_m2, points));
}
Vector3 ErrorSums::mean_rtn_m() const {
  return {mean_of(rtn_m.x(), epochs), mean_of(rtn_m.y(), epochs), mean_of(rtn_m.z(), epochs)};
}
Vector3 ErrorSums::rms_rtn_m() const {
  return {std::sqrt(mean_of(rtn_squares_m2.x(), epochs)), std::sqrt(mean_of(rtn_squares_m2.y(), epochs)),
          std::sqrt(mean_of(rtn_squares_m2.z(), epochs))};
}
double ErrorSums::mean_nees() const {
  return mean_of(nees, epochs);
}
double ErrorSums::mean_nis() const {
  return mean_of(nis, epochs);
}

void OrbitErrors::add(const OwnOrbitEpoch& epoch, const fsw::orbit::CartesianState& truth, const Vector3& antenna_eci) {
  const double after_s = fsw::seconds(epoch.time - first_);
  if (after_s < 0.0) return;
  const auto hour = static_cast<std::size_t>(after_s / 3600.0);
  if (hours_.size() <= hour) hours_.resize(hour + 1);
  ErrorSums& sums = hours_[hour];
  double point_m = 0.0;
  std::size_t satellites = 0;
  if (epoch.point.ok()) {
    const fsw::gnss::SinglePoint& point = epoch.point.value();
    // The position is that at reception, as early as the receiver's clock is fast.
    const Vector3 at_reception = antenna_eci - point.clock_m / fsw::gnss::kSpeedOfLight * truth.velocity_eci;
    point_m = (point.position_eci - at_reception).norm();
    satellites = point.used;
    ++sums.points;
    sums.point_squares_m2 += point_m * point_m;
  }
  if (!epoch.is_started) return;
  const Matrix3 R_rtn_eci = fsw::orbit::R_rtn_eci(truth);
  const Vector3 error = R_rtn_eci * (epoch.state.position_eci - truth.position_eci);
  const Matrix3 covariance = R_rtn_eci * epoch.covariance.topLeftCorner<3, 3>() * R_rtn_eci.transpose();
  const double nees = error.dot(covariance.ldlt().solve(error));
  ++sums.epochs;
  sums.rtn_m += error;
  sums.rtn_squares_m2 += error.cwiseAbs2();
  sums.nees += nees;
  sums.nis += epoch.nis;
  const Vector3 sigma = covariance.diagonal().cwiseSqrt();
  csv_ += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{:.3f},{:.3f},{}\n", after_s, error.x(),
                      error.y(), error.z(), sigma.x(), sigma.y(), sigma.z(), nees, epoch.nis, point_m, satellites);
}

ErrorSums OrbitErrors::of(std::size_t from_h, std::size_t to_h) const {
  ErrorSums sums;
  for (std::size_t hour = from_h; hour < std::min(to_h, hours_.size()); ++hour) sums.add(hours_[hour]);
  return sums;
}

double omitted_gravity_psd(double radius_m) {
  constexpr int kFirstDegree = 21, kLastDegree = 360;
  constexpr double kEarthRadius_m = 6378136.3;
  constexpr double kKaula = 1e-5;
  const double mu = fsw::orbit::kMu;
  const double surface_mps2 = mu / (radius_m * radius_m);
  const double mean_motion = std::sqrt(mu / radius_m) / radius_m;
  double psd = 0.0;
  for (int degree = kFirstDegree; degree <= kLastDegree; ++degree) {
    const double n = degree;
    // Variance of the coefficients of the degree; of their acceleration, all three axes together, at the orbit.
    const double coefficients = (2.0 * n + 1.0) * std::pow(kKaula / (n * n), 2);
    const double acceleration = surface_mps2 * surface_mps2 * (n + 1.0) * (2.0 * n + 1.0) *
                                std::pow(kEarthRadius_m / radius_m, 2.0 * n) * coefficients;
    // The integral of the covariance along the orbit: that of P_n(cos angle) over half a revolution is 1/n on average.
    psd += 2.0 / mean_motion * acceleration / n / 3.0;
  }
  return psd;
}

}  // namespace vbar::flown_gnss
