#pragma once
// Places of the axes of one robot, and their values on the wire.

#include <numbers>

#include <Eigen/Core>

#include "hil_drivers/tron/rsi/wire/messages.h"

namespace vbar::tron::rsi {

using AxisVector = Eigen::Matrix<double, 6, 1>;

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
inline constexpr double kMillimetresPerMetre = 1000.0;

/// Holds the axes of one robot: A1 to A6 in rad, and E1, the carriage from its home, in m (0 for a robot without a
/// track).
struct AxisPositions {
  AxisVector axes_rad = AxisVector::Zero();
  double track_m = 0.0;
};

inline SixValues to_degrees(const AxisVector& axes_rad) {
  SixValues axes_deg{};
  for (std::size_t k = 0; k < kWireAxes; ++k) axes_deg[k] = axes_rad[static_cast<int>(k)] * kDegreesPerRadian;
  return axes_deg;
}

inline AxisVector to_radians(const SixValues& axes_deg) {
  AxisVector axes_rad;
  for (std::size_t k = 0; k < kWireAxes; ++k) axes_rad[static_cast<int>(k)] = axes_deg[k] / kDegreesPerRadian;
  return axes_rad;
}

}  // namespace vbar::tron::rsi
