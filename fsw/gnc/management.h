#pragma once
// manage: telecommands, the waypoint table, and the state machine between approach and station keeping.

#include <array>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/gnc/inbox.h"

namespace vbar::fsw::gnc {

enum class Mode : std::int8_t {
  kIdle = 0,            ///< no command received yet
  kApproach = 1,        ///< transfer to the next waypoint of the table
  kStationKeeping = 2,  ///< keep the last waypoint reached
  kHold = 3,            ///< no burns until the next command
};

/// A relative orbit to be reached at a time.
struct Waypoint {
  std::int32_t index = -1;
  std::int8_t control_mode = 0;  ///< solver of the leg that ends here, numbers of control::Solver
  GpsTime time;
  Vector6 roe = Vector6::Zero();  ///< dimensionless mean ROE
};

class Management {
 public:
  static constexpr std::size_t kMaxWaypoints = 16;

  Management();

  /// Processes the telecommands of the inbox (configurations, tables, modes; each in order of time tags), then updates
  /// the state machine to `now`. A telecommand with an invalid value has no effect and is counted.
  void update(GpsTime now, Inbox& inbox);

  [[nodiscard]] Mode mode() const { return mode_; }
  [[nodiscard]] const gnc_configuration& configuration() const { return configuration_; }
  [[nodiscard]] double reference_semi_major_axis() const { return reference_semi_major_axis_; }

  /// The waypoint ahead (time later than the last update), or nullptr.
  [[nodiscard]] const Waypoint* next_waypoint() const { return next_ < count_ ? &waypoints_[next_] : nullptr; }
  /// The waypoint last passed, or nullptr.
  [[nodiscard]] const Waypoint* last_waypoint() const { return next_ > 0 ? &waypoints_[next_ - 1] : nullptr; }

 private:
  bool take(const waypoint_table& table);
  bool take(const gnc_configuration& configuration);
  bool take(const mode_command& command);

  Mode mode_ = Mode::kIdle;
  gnc_configuration configuration_;
  double reference_semi_major_axis_ = 0.0;
  std::array<Waypoint, kMaxWaypoints> waypoints_{};
  std::size_t count_ = 0;
  std::size_t next_ = 0;  ///< index of the waypoint ahead
};

}  // namespace vbar::fsw::gnc
