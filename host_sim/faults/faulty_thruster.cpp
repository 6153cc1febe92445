#include "host_sim/faults/faulty_thruster.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vbar::faults {

FaultyThruster::FaultyThruster(std::unique_ptr<twins::Actuator> thruster, std::vector<mission::Fault> faults)
    : thruster_(std::move(thruster)), faults_(std::move(faults)) {}

twins::Execution FaultyThruster::execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time,
                                         fsw::GpsTime now) {
  double scale = 1.0;
  bool is_reported = true;
  for (const mission::Fault& fault : faults_) {
    if (!fault.is_present(burn_time)) continue;
    if (fault.kind == mission::FaultKind::kThrustScale && command.maneuver_id < kFirstUncommanded) {
      scale *= fault.value;
      is_reported = is_reported && fault.is_reported;
    }
  }
  if (command.maneuver_id >= kFirstUncommanded) {
    twins::Execution execution = thruster_->execute(command, burn_time, now);
    const bool is_told = std::ranges::any_of(faults_, [&](const mission::Fault& fault) {
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

std::vector<UncommandedImpulse> uncommanded_impulses(const std::vector<mission::Fault>& faults) {
  std::vector<UncommandedImpulse> impulses;
  std::int32_t id = kFirstUncommanded;
  for (const mission::Fault& fault : faults) {
    if (fault.kind != mission::FaultKind::kThrustUncommanded) continue;
    const double total_s = fsw::seconds(*fault.duration);
    for (double from_s = 0.0; from_s < total_s; from_s += 1.0) {
      const double span_s = std::min(1.0, total_s - from_s);
      impulses.push_back({.time = fault.begin + fsw::nearest_duration(from_s + 0.5 * span_s),
                          .dv_rtn = fault.value * span_s * fault.direction_rtn,
                          .id = id++});
    }
  }
  return impulses;
}

}  // namespace vbar::faults
