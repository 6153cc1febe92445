#pragma once
// Detected faults: each persists, is raised with an event, latches with the time of its onset, and is cleared by
// telecommand. What a fault leads to is in fault_table.h.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_table.h"

namespace vbar::fsw::faults {

/// A detection that was checked.
struct Check {
  std::int32_t fault = 0;  ///< telemetry_health.kFault
  bool is_detected = false;
  std::int32_t device = 0;  ///< source of navigation concerned, a bit of navigation_configuration.sources; 0 none
  double argument = 0.0;    ///< as fault_table.h states
};

/// A change of a fault: an event is due.
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

  /// Records a check at `time`. One whose fault has occurred once and for all is checked once, with is_detected.
  void check(GpsTime time, const Check& check);

  /// Telecommand: those of `faults` are not latched any more; their persistence is reset.
  void clear(GpsTime time, std::int32_t faults);

  [[nodiscard]] std::int32_t latched() const { return latched_; }
  /// Of the latched ones, those that persist.
  [[nodiscard]] std::int32_t present() const { return present_; }
  /// Time of the onset of a latched fault.
  [[nodiscard]] GpsTime onset(std::int32_t fault) const { return states_[place_of(fault)].onset; }
  /// Whether a fault that is present calls for the response.
  [[nodiscard]] bool demands(Response response) const;

  /// Since forget_transitions(), in order.
  [[nodiscard]] std::span<const Transition> transitions() const {
    return std::span(transitions_).first(transition_count_);
  }
  void forget_transitions() { transition_count_ = 0; }
  /// Transitions for which there was no place.
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
