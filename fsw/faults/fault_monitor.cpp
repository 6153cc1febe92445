#include "fsw/faults/fault_monitor.h"

namespace vbar::fsw::faults {

FaultMonitor::FaultMonitor() {
  for (std::size_t k = 0; k < kFaultCount; ++k) {
    states_[k].persistence = Persistence(kFaultTable[k].limit, kFaultTable[k].window);
  }
}

void FaultMonitor::check(GpsTime time, const Check& check) {
  const std::size_t place = place_of(check.fault);
  const Rule& rule = kFaultTable[place];
  State& state = states_[place];
  const bool was_present = (present_ & rule.fault) != 0;
  const bool is_present = state.persistence.add(check.is_detected);
  if (is_present == was_present) return;
  if (is_present) {
    present_ |= rule.fault;
    // A latched fault that returns keeps its onset.
    if ((latched_ & rule.fault) == 0) state.onset = time;
    latched_ |= rule.fault;
    state.device = check.device;
    add({rule.fault, telemetry_event::kEventFaultRaised, rule.severity, time, check.device, check.argument});
  } else {
    present_ &= ~rule.fault;
    add({rule.fault, telemetry_event::kEventFaultEnded, telemetry_event::kSeverityInformation, time, state.device,
         check.argument});
  }
}

void FaultMonitor::clear(GpsTime time, std::int32_t faults) {
  for (std::size_t k = 0; k < kFaultCount; ++k) {
    const std::int32_t fault = kFaultTable[k].fault;
    if ((faults & latched_ & fault) == 0) continue;
    latched_ &= ~fault;
    present_ &= ~fault;
    states_[k].persistence.reset();
    add({fault, telemetry_event::kEventFaultCleared, telemetry_event::kSeverityInformation, time, states_[k].device,
         0.0});
  }
}

bool FaultMonitor::demands(Response response) const {
  for (const Rule& rule : kFaultTable) {
    if (rule.response == response && (present_ & rule.fault) != 0) return true;
  }
  return false;
}

void FaultMonitor::add(const Transition& transition) {
  if (transition_count_ == kMaxTransitions) {
    ++lost_;
    return;
  }
  transitions_[transition_count_++] = transition;
}

}  // namespace vbar::fsw::faults
