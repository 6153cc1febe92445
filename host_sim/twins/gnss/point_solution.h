#pragma once
// The receiver's own position, velocity and time, as in BESTXYZ and TIME: least squares of the GPS L1 code and
// Doppler with the broadcast satellites. Instead of an iteration it is solved once, linearised about the truth, which
// is the same to second order (errors of metres over ranges of 20,000 km).

#include <optional>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::twins::gnss {

/// One satellite: observed minus predicted at the true antenna, receiver clock included.
struct PointResidual {
  fsw::Vector3 line_of_sight = fsw::Vector3::Zero();  ///< antenna to satellite
  double code_m = 0.0;
  double range_rate_mps = 0.0;
  double code_sigma_m = 1.0;
};

struct PointSolution {
  std::size_t satellites = 0;
  fsw::Vector3 position_error_ecef = fsw::Vector3::Zero();  ///< solution minus truth, m
  fsw::Vector3 velocity_error_ecef = fsw::Vector3::Zero();  ///< m/s
  fsw::Vector3 position_sigma = fsw::Vector3::Zero();       ///< as the receiver states them
  fsw::Vector3 velocity_sigma = fsw::Vector3::Zero();
  double clock_offset_s = 0.0;  ///< estimated
  double clock_sigma_s = 0.0;
  double clock_drift = 0.0;  ///< estimated, s/s
};

/// Solves for position, velocity and clock; none with fewer than four satellites or a singular geometry.
std::optional<PointSolution> solve_point(const std::vector<PointResidual>& residuals);

}  // namespace vbar::twins::gnss
