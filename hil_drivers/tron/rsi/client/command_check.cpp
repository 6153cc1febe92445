#include "hil_drivers/tron/rsi/client/command_check.h"

#include <cmath>

#include <fmt/format.h>

#include "hil_drivers/tron/xml/document.h"

namespace vbar::tron::rsi {
namespace {

/// Rounding relative to a limit of speed or acceleration; a path planned to the limit is accepted.
constexpr double kRounding = 1e-6;
/// Absolute: positions of some radians, differenced twice over 4 ms, carry this much rounding of their own.
constexpr double kSpeedRounding = 1e-11;
constexpr double kAccelerationRounding = 1e-9;

struct AxisHistory {
  double zero, before_last, last, command;
};

struct AxisUnits {
  double wire_per_si;  ///< deg per rad, mm per m
  std::string_view wire, speed, acceleration;
};
constexpr AxisUnits kTurning{kDegreesPerRadian, "deg", "deg/s", "deg/s2"};
constexpr AxisUnits kSliding{kMillimetresPerMetre, "mm", "mm/s", "mm/s2"};

/// Comparisons are written so that a NaN is rejected.
std::string problem_of(const AxisHistory& axis, const CommandLimits& limits, const AxisUnits& units) {
  const double scale = units.wire_per_si;
  const double speed = (axis.command - axis.last) / kCycle_s;
  const double acceleration = (axis.command - 2.0 * axis.last + axis.before_last) / (kCycle_s * kCycle_s);
  const double correction = (axis.command - axis.zero) * scale;
  // An axis that stands beyond its range, by no fault of the command, may move back.
  const bool is_inside = (axis.command >= limits.lower || axis.command >= axis.last) &&
                         (axis.command <= limits.upper || axis.command <= axis.last);
  if (!std::isfinite(axis.command) || !is_inside)
    return fmt::format("position {:.4f} {}; accepted: {:.4f} to {:.4f}", axis.command * scale, units.wire,
                       limits.lower * scale, limits.upper * scale);
  if (!(correction >= limits.correction.lower && correction <= limits.correction.upper))
    return fmt::format("correction {:.4f} {}; accepted: {:.4f} to {:.4f}", correction, units.wire,
                       limits.correction.lower, limits.correction.upper);
  if (!(std::abs(speed) <= limits.speed * (1.0 + kRounding) + kSpeedRounding))
    return fmt::format("speed {:.4f} {}; accepted: up to {:.4f}", speed * scale, units.speed, limits.speed * scale);
  if (!(std::abs(acceleration) <= limits.acceleration * (1.0 + kRounding) + kAccelerationRounding))
    return fmt::format("acceleration {:.4f} {}; accepted: up to {:.4f}", acceleration * scale, units.acceleration,
                       limits.acceleration * scale);
  return {};
}

}  // namespace

void CommandCheck::begin(const AxisPositions& zero) {
  zero_ = last_ = before_last_ = zero;
}

std::string CommandCheck::advance(const AxisPositions& command) {
  for (std::size_t k = 0; k < kWireAxes; ++k) {
    const auto axis = static_cast<int>(k);
    const AxisHistory history{zero_.axes_rad[axis], before_last_.axes_rad[axis], last_.axes_rad[axis],
                              command.axes_rad[axis]};
    if (const std::string problem = problem_of(history, axes_[k], kTurning); !problem.empty())
      return fmt::format("{}: {}", xml::kAxisNames[k], problem);
  }
  if (track_) {
    const AxisHistory history{zero_.track_m, before_last_.track_m, last_.track_m, command.track_m};
    if (const std::string problem = problem_of(history, *track_, kSliding); !problem.empty()) return "E1: " + problem;
  }
  before_last_ = last_;
  last_ = command;
  return {};
}

}  // namespace vbar::tron::rsi
