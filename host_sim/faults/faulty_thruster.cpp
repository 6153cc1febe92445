#include "host_sim/faults/faulty_thruster.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vbar::faults {

FaultyThruster::FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::shared_ptr<FaultSchedule> schedule)
    : thruster_(std::move(thruster)), schedule_(std::move(schedule)) {}

twins::Execution FaultyThruster::execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time,
                                         fsw::GpsTime now) {
  if (command.maneuver_id < kFirstUncommanded && burn_time >= now) schedule_->on_ignition(burn_time);
  double scale = 1.0;
  bool is_reported = true;
  for (const mission::Fault& fault : schedule_->faults()) {
    if (!fault.is_present(burn_time)) continue;
    if (fault.kind == mission::FaultKind::kThrustScale && command.maneuver_id < kFirstUncommanded) {
      scale *= fault.value;
      is_reported = is_reported && fault.is_reported;
    }
  }
  if (command.maneuver_id >= kFirstUncommanded) {
    twins::Execution execution = thruster_->execute(command, burn_time, now);
    const bool is_told = std::ranges::any_of(schedule_->faults(), [&](const mission::Fault& fault) {
      return fault.kind == mission::FaultKind::kThrustUncommanded && fault.is_present(burn_time) && fault.is_reported;
    });
    if (!is_told) execution.packet.clear();
    return execution;
  }
  if (scale == 1.0) return thruster_->execute(command, burn_time, now);
  vbar::maneuver_command scaled = command;
  for (double& dv : scaled.dv_rtn) dv *= scale;
  twins::Execution execution = thruster_->execute(scaled, burn_time, now);
  if (!is_reported) execution.packet = thruster_->execute(command, burn_time, now).packet;
  return execution;
}

UncommandedImpulses::UncommandedImpulses(std::shared_ptr<const FaultSchedule> schedule)
    : schedule_(std::move(schedule)), is_taken_(schedule_->faults().size(), false) {}

std::vector<UncommandedImpulse> UncommandedImpulses::take() {
  std::vector<UncommandedImpulse> impulses;
  for (std::size_t k = 0; k < is_taken_.size(); ++k) {
    const mission::Fault& fault = schedule_->faults()[k];
    if (is_taken_[k] || fault.awaited || fault.kind != mission::FaultKind::kThrustUncommanded) continue;
    is_taken_[k] = true;
    const double total_s = fsw::seconds(*fault.duration);
    for (double from_s = 0.0; from_s < total_s; from_s += 1.0) {
      const double span_s = std::min(1.0, total_s - from_s);
      impulses.push_back({.time = fault.begin + fsw::nearest_duration(from_s + 0.5 * span_s),
                          .dv_rtn = fault.value * span_s * fault.direction_rtn,
                          .id = next_id_++});
    }
  }
  return impulses;
}

}  // namespace vbar::faults
