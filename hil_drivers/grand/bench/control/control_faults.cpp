#include "hil_drivers/grand/bench/control/control_common.h"

namespace vbar::grand::bench {

FaultEffect fault_of(const ControlFaults& faults, std::string_view command, ControlStatistics& statistics) {
  const auto is = [&](const std::string& name) { return !name.empty() && name == command; };
  FaultEffect effect = FaultEffect::kNone;
  if (faults.is_silent || is(faults.unanswered_command)) effect = FaultEffect::kNoAnswer;
  if (is(faults.refused_command)) effect = FaultEffect::kRefusal;
  if (is(faults.closing_command)) effect = FaultEffect::kClosing;
  if (effect != FaultEffect::kNone) ++statistics.faults_applied;
  return effect;
}

}  // namespace vbar::grand::bench
