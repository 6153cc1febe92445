#pragma once
// Check of a command to the axes against the limits of one cycle.

#include <array>
#include <optional>
#include <string>

#include "hil_drivers/tron/rsi/client/axis_positions.h"
#include "hil_drivers/tron/rsi/wire/context_xml.h"

namespace vbar::tron::rsi {

/// Holds the limits of one axis of a command.
struct CommandLimits {
  double lower = 0.0, upper = 0.0;  ///< rad (m from home)
  double speed = 0.0;               ///< rad/s (m/s)
  double acceleration = 0.0;        ///< rad/s2 (m/s2)
  CorrectionRange correction;       ///< deg (mm), of the context
};

class CommandCheck {
 public:
  CommandCheck(const std::array<CommandLimits, kWireAxes>& axes, const std::optional<CommandLimits>& track)
      : axes_(axes), track_(track) {}

  /// Starts at rest at `zero`, from which corrections count.
  void begin(const AxisPositions& zero);
  /// Accepts the command as that of the next cycle. A rejected one is ignored, and the result is one sentence with
  /// axis, value and limit.
  [[nodiscard]] std::string advance(const AxisPositions& command);

  [[nodiscard]] const AxisPositions& zero() const { return zero_; }
  [[nodiscard]] const AxisPositions& last() const { return last_; }

 private:
  std::array<CommandLimits, kWireAxes> axes_;
  std::optional<CommandLimits> track_;
  AxisPositions zero_, last_, before_last_;
};

}  // namespace vbar::tron::rsi
