#pragma once
// Executes maneuver commands.

#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

/// Result of the execution of a command.
struct Execution {
  fsw::GpsTime time;  ///< time of the impulse, or of the rejected one
  vbar::executed_maneuver
      maneuver{};  ///< accepted or not, and the impulse that happened, m/s in the servicer's RTN at `time`
  Packet packet;   ///< `maneuver` as sent to the flight software; empty: nothing is sent
  std::vector<Note> notes;
};

class Actuator {
 public:
  Actuator() = default;
  Actuator(const Actuator&) = delete;
  Actuator& operator=(const Actuator&) = delete;
  virtual ~Actuator() = default;

  /// Executes `command` at `burn_time`, the time tag of its packet. A burn before `now` is rejected: accepted is 0, the
  /// impulse 0. The caller applies the impulse to the truth at Execution::time and delivers the packet.
  virtual Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) = 0;
};

}  // namespace vbar::twins
