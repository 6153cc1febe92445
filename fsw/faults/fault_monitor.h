#pragma once
// Fault monitor: a detection that persists raises its fault with an event. The fault latches with the time of its onset
// and is cleared by telecommand. fault_table.h states the response to each fault.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_table.h"

namespace vbar::fsw::faults {

/// Holds the result of one check of a fault.
struct Check {
  std::int32_t fault = 0;  ///< telemetry_health.kFault
  bool is_detected = false;
  std::int32_t device = 0;  ///< measurement source concerned, a bit of navigation_configuration.sources; 0 none
  double argument = 0.0;    ///< as fault_table.h states
};

/// Describes a change of a fault, for which an event is due.
struct Transition {
  std::int32_t fault = 0;
  std::int8_t event = 0;  ///< telemetry_event.kEventFault...
  std::int8_t severity = 0;
  GpsTime time;
  std::int32_t device = 0;
  double argument = 0.0;
};

class FaultMonitor {
 public:
  FaultMonitor();

  /// Records a check at `time`. A fault that is an occurrence, not a condition, is checked once, with is_detected.
  void check(GpsTime time, const Check& check);

  /// Clears the latched ones of `faults`, by telecommand, and resets their persistence.
  void clear(GpsTime time, std::int32_t faults);

  [[nodiscard]] std::int32_t latched() const { return latched_; }
  /// Returns the latched faults that persist.
  [[nodiscard]] std::int32_t present() const { return present_; }
  /// Returns the time of the onset of a latched fault.
  [[nodiscard]] GpsTime onset(std::int32_t fault) const { return states_[place_of(fault)].onset; }
  /// Returns whether a fault that is present demands the response.
  [[nodiscard]] bool demands(Response response) const;

  /// Returns the transitions since forget_transitions(), in order.
  [[nodiscard]] std::span<const Transition> transitions() const {
    return std::span(transitions_).first(transition_count_);
  }
  void forget_transitions() { transition_count_ = 0; }
  /// Returns the number of transitions for which there was no place.
  [[nodiscard]] std::int32_t lost_transitions() const { return lost_; }

 private:
  struct State {
    Persistence persistence{1, 1};
    GpsTime onset;
    std::int32_t device = 0;
  };
  void add(const Transition& transition);

  static constexpr std::size_t kMaxTransitions = 2 * kFaultCount;

  std::array<State, kFaultCount> states_{};
  std::int32_t latched_ = 0;
  std::int32_t present_ = 0;
  std::array<Transition, kMaxTransitions> transitions_{};
  std::size_t transition_count_ = 0;
  std::int32_t lost_ = 0;
};

}  // namespace vbar::fsw::faults
