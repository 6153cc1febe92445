#pragma once
// Rows of a record with a given relative state, for tests of navigation errors.

#include <Eigen/Core>

#include "host_sim/report/run_record.h"

namespace vbar::report::test {

using Vector6 = Eigen::Matrix<double, 6, 1>;

inline constexpr double kRadius_m = 7.0e6;
inline constexpr double kRate_radps = 1.0780007612e-3;  // sqrt(mu / r^3), mu = 3.986004418e14 m^3/s^2

/// A circular orbit at its node.
inline TruthRow truth_at(double time_s, const Vector6& relative) {
  TruthRow row;
  row.time_s = time_s;
  row.servicer_position_eci = {kRadius_m, 0.0, 0.0};
  row.servicer_velocity_eci = {0.0, kRadius_m * kRate_radps, 0.0};
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

inline EstimateRow estimate_at(double time_s, const Vector6& relative, int source) {
  EstimateRow row;
  row.time_s = time_s;
  row.navigation_valid = 1;
  row.navigation_source = source;
  row.relative_position_rtn = {relative(0), relative(1), relative(2)};
  row.relative_velocity_rtn = {relative(3), relative(4), relative(5)};
  return row;
}

}  // namespace vbar::report::test
