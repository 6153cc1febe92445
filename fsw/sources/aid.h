#pragma once
// The state of a source of measurements as an aid of the trunk: one machine for all sources.
//
//   off -> waiting (for its first usable record) -> starting (initialising) -> aiding <-> suspended -> failed
//
// A failed or suspended source deactivates its own blocks and no others; it may start again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"

namespace vbar::fsw::sources {

/// Numbers of telemetry_event, states of a source.
enum class AidState : std::uint8_t {
  kOff,        ///< not selected, or not configured
  kWaiting,    ///< no usable record yet
  kStarting,   ///< records are collected to initialise something
  kAiding,     ///< its rows update the trunk
  kSuspended,  ///< nothing usable for a time, or its records contradict the trunk
  kFailed,     ///< its own estimates were discarded
};

struct AidTransition {
  AidState before = AidState::kOff;
  AidState after = AidState::kOff;
  GpsTime time;
};

class Aid {
 public:
  explicit Aid(AidState initial = AidState::kOff) : state_(initial) {}

  [[nodiscard]] AidState state() const { return state_; }
  [[nodiscard]] GpsTime since() const { return since_; }
  [[nodiscard]] bool is_on() const { return state_ != AidState::kOff; }

  void go_to(AidState next, GpsTime time) {
    if (next == state_) return;
    // Of more transitions than fit, the last ones are merged into one.
    if (transition_count_ == kMaxTransitions) {
      transitions_.back().after = next;
      transitions_.back().time = time;
    } else {
      transitions_[transition_count_++] = {state_, next, time};
    }
    state_ = next;
    since_ = time;
  }

  /// Since forget_transitions(), in order: an event is due for each.
  [[nodiscard]] std::span<const AidTransition> transitions() const {
    return std::span(transitions_).first(transition_count_);
  }
  void forget_transitions() { transition_count_ = 0; }

 private:
  static constexpr std::size_t kMaxTransitions = 8;

  AidState state_;
  GpsTime since_;
  std::array<AidTransition, kMaxTransitions> transitions_{};
  std::size_t transition_count_ = 0;
};

}  // namespace vbar::fsw::sources
