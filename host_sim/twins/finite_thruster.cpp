#include "host_sim/twins/finite_thruster.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace vbar::twins {
namespace {

fsw::Vector3 dv_of(const vbar::maneuver_command& command) {
  return fsw::Vector3(command.dv_rtn[0], command.dv_rtn[1], command.dv_rtn[2]);
}

/// Time for which the valve is open.
double on_time_of(const truth::ThrustArc& arc) {
  return arc.rise_s + arc.hold_s;
}

}  // namespace

FiniteThruster::FiniteThruster(const Settings& settings, const engine::RandomStream& stream)
    : settings_(settings), stream_(stream), encoder_(settings.spacecraft_number, settings.unit) {}

/// By the rocket equation with the nominal mass: impulse = (propellant) times (exhaust velocity). A pulse too short for
/// full thrust has the slopes of the others and a lower peak.
truth::ThrustArc FiniteThruster::arc_of(const fsw::Vector3& dv_rtn) const {
  const ThrusterProperties& thruster = settings_.thruster;
  const double exhaust_mps = thruster.exhaust_velocity_mps();
  const double dv = dv_rtn.norm();
  const double impulse_ns = -std::expm1(-dv / exhaust_mps) * (settings_.nominal_mass_kg - used_kg_) * exhaust_mps;
  truth::ThrustArc arc{.rise_s = thruster.rise_s,
                       .fall_s = thruster.fall_s,
                       .peak_n = thruster.thrust_n,
                       .mass_kg = settings_.mass_kg - used_kg_,
                       .exhaust_velocity_mps = exhaust_mps};
  if (dv > 0.0) arc.direction_rtn = dv_rtn / dv;
  const double of_edges_ns = 0.5 * arc.peak_n * (arc.rise_s + arc.fall_s);
  if (impulse_ns >= of_edges_ns) {
    arc.hold_s = (impulse_ns - of_edges_ns) / arc.peak_n;
  } else {
    const double share = std::sqrt(impulse_ns / of_edges_ns);
    arc.rise_s *= share;
    arc.fall_s *= share;
    arc.peak_n *= share;
  }
  return arc;
}

fsw::Duration FiniteThruster::lead(const vbar::maneuver_command& command) const {
  return fsw::nearest_duration(0.5 * arc_of(dv_of(command)).duration_s());
}

const char* FiniteThruster::reason_against(const truth::ThrustArc& arc, fsw::GpsTime begin, fsw::GpsTime now) const {
  const ThrusterProperties& thruster = settings_.thruster;
  const double impulse_ns = arc.impulse_ns(arc.end_s());
  if (begin < now) return "too late to begin";
  if (begin < busy_until_) return "before the last burn has ended";
  if (impulse_ns < thruster.minimum_impulse_ns * (1.0 - 1e-9)) return "below the smallest impulse";
  if (on_time_of(arc) > thruster.maximum_on_time_s * (1.0 + 1e-9)) return "beyond the longest on-time";
  if (used_kg_ + impulse_ns / arc.exhaust_velocity_mps > thruster.propellant_kg) return "without propellant for it";
  return nullptr;
}

Packet FiniteThruster::report_of(const vbar::executed_maneuver& maneuver, fsw::GpsTime burn_time) {
  std::optional<Packet> packet = encoder_.encode(burn_time, maneuver);
  if (!packet) throw std::runtime_error("thruster: a maneuver command that is not finite");
  return std::move(*packet);
}

Execution FiniteThruster::execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) {
  Execution execution;
  execution.time = burn_time;
  execution.maneuver.maneuver_id = command.maneuver_id;
  truth::ThrustArc arc = arc_of(dv_of(command));
  const fsw::GpsTime begin = burn_time - fsw::nearest_duration(0.5 * arc.duration_s());
  if (const char* const reason = reason_against(arc, begin, now); reason != nullptr) {
    execution.notes.push_back({"rejected", 1.0, reason});
  } else {
    // Errors are those of flow and of direction: the valve's times are as computed.
    const fsw::Vector3 executed =
        settings_.errors.applied_to(dv_of(command), command.maneuver_id, stream_, execution.notes);
    const double commanded = dv_of(command).norm();
    if (commanded > 0.0) {
      arc.peak_n *= executed.norm() / commanded;
      arc.direction_rtn = executed.normalized();
    }
    const double propellant_kg = arc.impulse_ns(arc.end_s()) / arc.exhaust_velocity_mps;
    const double mass_after_kg = arc.mass_kg - propellant_kg;
    const fsw::Vector3 dv_rtn = arc.exhaust_velocity_mps * std::log(arc.mass_kg / mass_after_kg) * arc.direction_rtn;
    execution.maneuver.accepted = 1;
    std::copy(dv_rtn.begin(), dv_rtn.end(), execution.maneuver.dv_rtn);
    used_kg_ += propellant_kg;
    busy_until_ = begin + fsw::nearest_duration(arc.duration_s());
    execution.notes.push_back({"on_time_s", on_time_of(arc)});
    execution.notes.push_back({"propellant_kg", propellant_kg});
    execution.notes.push_back({"mass_kg", mass_after_kg});
    execution.arc = arc;
  }
  execution.packet = report_of(execution.maneuver, burn_time);
  return execution;
}

Execution FiniteThruster::leak(const vbar::maneuver_command& impulse, fsw::GpsTime time) {
  Execution execution;
  execution.time = time;
  execution.maneuver.maneuver_id = impulse.maneuver_id;
  execution.maneuver.accepted = 1;
  std::ranges::copy(impulse.dv_rtn, execution.maneuver.dv_rtn);
  used_kg_ +=
      -std::expm1(-dv_of(impulse).norm() / settings_.thruster.exhaust_velocity_mps()) * (settings_.mass_kg - used_kg_);
  execution.packet = report_of(execution.maneuver, time);
  return execution;
}

Packet FiniteThruster::pretended_report(const vbar::maneuver_command& command, fsw::GpsTime burn_time) {
  vbar::executed_maneuver maneuver{};
  maneuver.maneuver_id = command.maneuver_id;
  maneuver.accepted = 1;
  std::ranges::copy(command.dv_rtn, maneuver.dv_rtn);
  return report_of(maneuver, burn_time);
}

}  // namespace vbar::twins
