#pragma once
// Executes maneuver commands.

#include <cstdint>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/truth/forces/thrust_force.h"
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
  std::optional<truth::ThrustArc> arc;  ///< the burn that begins now, in place of an impulse; `maneuver` is its outcome
};

class Actuator {
 public:
  Actuator() = default;
  Actuator(const Actuator&) = delete;
  Actuator& operator=(const Actuator&) = delete;
  virtual ~Actuator() = default;

  /// Returns how long before the time tag of its command a burn begins: half its duration.
  [[nodiscard]] virtual fsw::Duration lead(const vbar::maneuver_command& /*command*/) const { return {}; }

  /// Executes `command`, whose packet has the time tag `burn_time`, from `now` on, a lead before. A burn that had to
  /// begin before `now` is rejected: accepted is 0, the impulse 0. The caller applies impulse or arc to the truth and
  /// delivers the packet when it has ended.
  virtual Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) = 0;

  /// Executes an impulse that was not commanded, of a valve that does not close.
  virtual Execution leak(const vbar::maneuver_command& impulse, fsw::GpsTime time) {
    return execute(impulse, time, time);
  }
  /// Returns the report of a burn as if it had been executed in full.
  [[nodiscard]] virtual Packet pretended_report(const vbar::maneuver_command& command, fsw::GpsTime burn_time) {
    return execute(command, burn_time, burn_time).packet;
  }
};

/// Errors of the burns of a thruster, drawn by the number of each, independently of other burns.
struct BurnErrors {
  double magnitude = 0.0;     ///< 1 sigma, relative
  double pointing_rad = 0.0;  ///< 1 sigma, about each of two axes across the burn

  /// Returns the burn as executed, m/s; without errors the commanded one, bit for bit. Notes: the errors.
  [[nodiscard]] fsw::Vector3 applied_to(const fsw::Vector3& dv_rtn, std::int32_t maneuver_id,
                                        const engine::RandomStream& stream, std::vector<Note>& notes) const;
};

// An impulsive thruster: ideal, or with errors of magnitude and pointing.

class IdealThruster final : public Actuator {
 public:
  struct Settings {
    std::uint8_t spacecraft_number = 0;
    std::uint8_t unit = 0;
    BurnErrors errors;
  };

  /// Makes a thruster; `stream` is the thruster's own.
  IdealThruster(const Settings& settings, const engine::RandomStream& stream);

  Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;

 private:
  Settings settings_;
  engine::RandomStream stream_;
  PacketEncoder encoder_;
};

}  // namespace vbar::twins
