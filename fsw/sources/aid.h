#pragma once
// The state of a source of measurements as an aid of the trunk: one machine for all sources.
//
//   off -> waiting (for its first usable record) -> starting (initialising) -> aiding <-> suspended -> failed
//
// A failed or suspended source deactivates its own blocks and no others; it may start again.

#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"

namespace vbar::fsw::sources {

enum class AidState : std::uint8_t {
  kOff,        ///< not selected, or not configured
  kWaiting,    ///< no usable record yet
  kStarting,   ///< records are collected to initialise something
  kAiding,     ///< its rows update the trunk
  kSuspended,  ///< nothing usable for a time, or its records contradict the trunk
  kFailed,     ///< its own estimates were discarded
};

class Aid {
 public:
  [[nodiscard]] AidState state() const { return state_; }
  [[nodiscard]] GpsTime since() const { return since_; }
  [[nodiscard]] bool is_on() const { return state_ != AidState::kOff; }

  void go_to(AidState next, GpsTime time) {
    if (next == state_) return;
    state_ = next;
    since_ = time;
    has_changed_ = true;
  }
  /// Whether the state has changed since the last call: then an event is due.
  [[nodiscard]] bool take_change() {
    const bool changed = has_changed_;
    has_changed_ = false;
    return changed;
  }

 private:
  AidState state_ = AidState::kOff;
  GpsTime since_;
  bool has_changed_ = false;
};

}  // namespace vbar::fsw::sources
