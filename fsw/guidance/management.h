#pragma once
// manage: telecommands, the waypoint table, and the state machine between approach and station keeping.

#include <array>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/messaging/telecommands.h"

namespace vbar::fsw::guidance {

enum class Mode : std::int8_t {
  kIdle = 0,            ///< no command received yet
  kApproach = 1,        ///< transfer to the next waypoint of the table
  kStationKeeping = 2,  ///< keep the last waypoint reached
  kHold = 3,            ///< no burns until the next command
  kRetreat = 4,         ///< recede from the target, then keep station on a safe orbit, until the next command
};

/// Holds a relative orbit to be reached at a time.
struct Waypoint {
  std::int32_t index = -1;
  std::int8_t control_mode = 0;  ///< solver of the leg that ends here, kId of the solver list
  GpsTime time;
  Vector6 roe = Vector6::Zero();   ///< dimensionless mean ROE
  double keep_out_radius_m = 0.0;  ///< distance to be kept by drifts after the burns of the leg that ends here
};

class Management {
 public:
  static constexpr std::size_t kMaxWaypoints = 16;

  Management();

  /// Processes the telecommands that are new in the store (configuration, table, mode), then updates the state machine
  /// to `now`.
  void update(GpsTime now, const messaging::Telecommands& telecommands);

  /// Returns the mode. Station keeping before the first waypoint is idle: there is no position to keep yet. A mode that
  /// burns is hold while it is suspended.
  [[nodiscard]] Mode mode() const {
    if (mode_ == Mode::kStationKeeping && next_ == 0) return Mode::kIdle;
    const bool burns = mode_ == Mode::kApproach || mode_ == Mode::kStationKeeping;
    return burns && is_suspended_ ? Mode::kHold : mode_;
  }
  /// Suspends the approach, or resumes it.
  void suspend(bool is_suspended) { is_suspended_ = is_suspended; }
  /// Starts the retreat that a fault demands, until the next mode command. Has no effect while idle.
  void retreat() {
    if (mode() != Mode::kIdle) mode_ = Mode::kRetreat;
  }
  /// Returns the safety configuration in force, or nullptr.
  [[nodiscard]] const safety_configuration* safety() const { return has_safety_ ? &safety_ : nullptr; }
  [[nodiscard]] const gnc_configuration& configuration() const { return configuration_; }
  /// Returns the thruster: with impulses, if no telecommand says otherwise.
  [[nodiscard]] const thruster_configuration& thruster() const { return thruster_; }
  [[nodiscard]] double reference_semi_major_axis() const { return reference_semi_major_axis_; }

  /// Returns the waypoint ahead (time later than the last update), or nullptr.
  [[nodiscard]] const Waypoint* next_waypoint() const { return next_ < count_ ? &waypoints_[next_] : nullptr; }
  /// Returns the waypoint last passed, or nullptr.
  [[nodiscard]] const Waypoint* last_waypoint() const { return next_ > 0 ? &waypoints_[next_ - 1] : nullptr; }

 private:
  void take(GpsTime now, const waypoint_table& table);
  void pass_waypoints(GpsTime now);

  Mode mode_ = Mode::kIdle;
  bool is_suspended_ = false;
  gnc_configuration configuration_;
  thruster_configuration thruster_{};
  safety_configuration safety_{};
  bool has_safety_ = false;
  double reference_semi_major_axis_ = 0.0;
  std::array<Waypoint, kMaxWaypoints> waypoints_{};
  std::size_t count_ = 0;
  std::size_t next_ = 0;  ///< index of the waypoint ahead
};

}  // namespace vbar::fsw::guidance
