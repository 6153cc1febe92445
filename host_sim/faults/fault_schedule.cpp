#include "host_sim/faults/fault_schedule.h"

#include <algorithm>
#include <utility>

#include "fsw/packets/messages.h"

namespace vbar::faults {

using fsw::GpsTime;
using Kind = mission::FaultEvent::Kind;

FaultSchedule::FaultSchedule(std::vector<mission::Fault> faults, std::string servicer, std::string target)
    : faults_(std::move(faults)), servicer_(std::move(servicer)), target_(std::move(target)) {}

bool FaultSchedule::awaits(Kind kind) const {
  return std::ranges::any_of(
      faults_, [kind](const mission::Fault& fault) { return fault.awaited && fault.awaited->kind == kind; });
}

template <class Accept>
void FaultSchedule::happen(Kind kind, GpsTime time, const Accept& accept) {
  for (mission::Fault& fault : faults_) {
    if (!fault.awaited || fault.awaited->kind != kind || !accept(fault.awaited->argument)) continue;
    fault.begin = time + fault.awaited->delay;
    fault.awaited.reset();
  }
}

void FaultSchedule::on_ignition(GpsTime time) {
  ++burns_;
  happen(Kind::kBurn, time, [this](double number) { return number == burns_; });
}

void FaultSchedule::on_truth(const twins::TruthSnapshot& truth) {
  if (!awaits(Kind::kRangeBelow)) return;
  const twins::SpacecraftTruth* const servicer = truth.find(servicer_);
  const twins::SpacecraftTruth* const target = truth.find(target_);
  if (servicer == nullptr || target == nullptr) return;
  const double range_m = (target->orbit.position_eci - servicer->orbit.position_eci).norm();
  happen(Kind::kRangeBelow, truth.time, [range_m](double limit_m) { return range_m < limit_m; });
}

void FaultSchedule::on_step(std::uint32_t /*step*/, GpsTime time, std::span<const pil::Packet> /*inputs*/,
                            std::span<const pil::Packet> outputs) {
  if (!awaits(Kind::kFirstFix)) return;
  for (const pil::Packet& bytes : outputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    const auto telemetry = fsw::packets::decode<telemetry_gnss>(packet.value());
    if (telemetry.ok() && telemetry.value().fixed > 0)
      happen(Kind::kFirstFix, time, [](double /*argument*/) { return true; });
  }
}

}  // namespace vbar::faults
