#pragma once
// A thruster as it is: burns have a duration, a smallest impulse, a rise and a fall, and use propellant.

#include "host_sim/twins/actuator.h"
#include "host_sim/twins/thruster_properties.h"

namespace vbar::twins {

class FiniteThruster final : public Actuator {
 public:
  struct Settings {
    std::uint8_t spacecraft_number = 0;
    std::uint8_t unit = 0;
    BurnErrors errors;
    ThrusterProperties thruster;
    double mass_kg = 0.0;          ///< true mass at the start, with the propellant
    double nominal_mass_kg = 0.0;  ///< by which on-times are computed
  };

  FiniteThruster(const Settings& settings, const engine::RandomStream& stream);

  [[nodiscard]] fsw::Duration lead(const vbar::maneuver_command& command) const override;

  /// Executes a burn about its time tag. It is rejected below the impulse bit, beyond the longest on-time, before the
  /// last one has ended, without the propellant for it, and if it is late. Notes: errors, on-time, propellant of the
  /// burn, mass after it, or the reason of the rejection.
  Execution execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) override;

  Execution leak(const vbar::maneuver_command& impulse, fsw::GpsTime time) override;
  [[nodiscard]] Packet pretended_report(const vbar::maneuver_command& command, fsw::GpsTime burn_time) override;

  [[nodiscard]] double propellant_used_kg() const { return used_kg_; }

 private:
  [[nodiscard]] truth::ThrustArc arc_of(const fsw::Vector3& dv_rtn) const;
  [[nodiscard]] const char* reason_against(const truth::ThrustArc& arc, fsw::GpsTime begin, fsw::GpsTime now) const;
  [[nodiscard]] Packet report_of(const vbar::executed_maneuver& maneuver, fsw::GpsTime burn_time);

  Settings settings_;
  engine::RandomStream stream_;
  PacketEncoder encoder_;
  fsw::GpsTime busy_until_;
  double used_kg_ = 0.0;
};

}  // namespace vbar::twins
