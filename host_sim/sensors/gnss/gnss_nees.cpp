#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "host_sim/report/navigation_errors.h"
#include "host_sim/sensors/gnss/gnss_row.h"

namespace vbar::sensors {
namespace {

using report::NavigationError;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Vector3d vector(const report::Triple& v) {
  return {v[0], v[1], v[2]};
}

/// Orbital rate of the servicer about the Earth, rad/s.
double orbital_rate(const report::TruthRow& truth) {
  const Eigen::Vector3d r = vector(truth.servicer_position_eci);
  return r.cross(vector(truth.servicer_velocity_eci)).norm() / r.squaredNorm();
}

/// Clohessy and Wiltshire (1960): state transition of a relative state in RTN over t seconds, circular orbit of rate n.
Matrix6 clohessy_wiltshire(double n, double t) {
  const double s = std::sin(n * t);
  const double c = std::cos(n * t);
  Matrix6 transition;
  transition << 4.0 - 3.0 * c, 0.0, 0.0, s / n, 2.0 * (1.0 - c) / n, 0.0,                   //
      6.0 * (s - n * t), 1.0, 0.0, -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * n * t) / n, 0.0,  //
      0.0, 0.0, c, 0.0, 0.0, s / n,                                                         //
      3.0 * n * s, 0.0, 0.0, c, 2.0 * s, 0.0,                                               //
      -6.0 * n * (1.0 - c), 0.0, 0.0, -2.0 * s, 4.0 * c - 3.0, 0.0,                         //
      0.0, 0.0, -n * s, 0.0, 0.0, c;
  return transition;
}

Matrix6 symmetric(const double (&lower)[21]) {
  Matrix6 matrix;
  std::size_t place = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) matrix(row, column) = matrix(column, row) = lower[place++];
  }
  return matrix;
}

std::optional<double> nees(const NavigationError& error, const GnssRow& gnss, double rate) {
  if (!gnss.epoch_s) return std::nullopt;
  const Matrix6 transition = clohessy_wiltshire(rate, error.time_s - *gnss.epoch_s);
  const Matrix6 covariance = transition * symmetric(gnss.covariance_rtn) * transition.transpose();
  const Eigen::LLT<Matrix6> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Vector6 e;
  e << vector(error.position_rtn), vector(error.velocity_rtn);
  return factor.matrixL().solve(e).squaredNorm();
}

template <class Row>
std::map<double, const Row*> by_time(const std::vector<Row>& rows) {
  std::map<double, const Row*> found;
  for (const Row& row : rows) found[row.time_s] = &row;
  return found;
}

/// Whether the estimate of a step is by GNSS measurements of that step.
bool is_fresh(const report::EstimateRow& estimate) {
  return estimate.navigation_source == telemetry_navigation::kSourceGnssFloat ||
         estimate.navigation_source == telemetry_navigation::kSourceGnssFixed;
}

}  // namespace

std::map<double, double> gnss_nees(const report::RunRecord& record) {
  const auto truth_at = by_time(record.truth);
  const auto gnss_at = by_time(record.tables.rows<GnssRow>());
  const auto estimate_at = by_time(record.estimates);
  std::map<double, double> all;
  for (const NavigationError& error : report::navigation_errors(record)) {
    const auto gnss = gnss_at.find(error.time_s);
    if (gnss == gnss_at.end() || !is_fresh(*estimate_at.at(error.time_s))) continue;
    if (const auto value = nees(error, *gnss->second, orbital_rate(*truth_at.at(error.time_s))))
      all[error.time_s] = *value;
  }
  return all;
}

}  // namespace vbar::sensors
