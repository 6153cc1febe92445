#pragma once
// Executes maneuver commands.

#include <cstdint>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/packet_encoder.h"
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

// An impulsive thruster: ideal, or with errors of magnitude and pointing.

class IdealThruster final : public Actuator {
 public:
  struct Settings {
    std::uint8_t spacecraft_number = 0;
    std::uint8_t unit = 0;
    double magnitude_error = 0.0;     ///< 1 sigma, relative
    double pointing_error_rad = 0.0;  ///< 1 sigma, about each of two axes across the impulse
  };

  /// Makes a thruster; `stream` is the thruster's own. The errors of a burn are drawn by its maneuver_id, independently
  /// of other burns.
  IdealThruster(const Settings& settings, const engine::RandomStream& stream);

  /// Executes a burn. Without errors the executed impulse is the commanded one, bit for bit. Notes: the errors of the
  /// burn.
  Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;

 private:
  [[nodiscard]] fsw::Vector3 with_errors(const fsw::Vector3& dv_rtn, std::int32_t maneuver_id,
                                         std::vector<Note>& notes) const;

  Settings settings_;
  engine::RandomStream stream_;
  PacketEncoder encoder_;
};

}  // namespace vbar::twins
