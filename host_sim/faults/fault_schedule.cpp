#include "host_sim/faults/fault_schedule.h"

#include <algorithm>
#include <utility>

#include "fsw/packets/messages.h"
#include "host_sim/installation/sensor_kinds.h"

namespace vbar::faults {

using fsw::packets::Apid;
using mission::FaultKind;

std::optional<StreamKey> stream_of(const mission::Mission& mission, const mission::Fault& fault) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (spacecraft.name != fault.spacecraft) continue;
    for (const mission::Sensor& sensor : spacecraft.sensors) {
      if (sensor.name != fault.unit) continue;
      const sensors::MeasurementPackets& packets = sensors::kind_of(sensor).packets;
      const Apid apid = spacecraft.flight_computer ? packets.apid : packets.by_crosslink.value_or(packets.apid);
      return StreamKey{apid, packets.unit != nullptr ? packets.unit(sensor, spacecraft) : std::uint8_t{0}};
    }
  }
  return std::nullopt;
}

std::int32_t aids_concerned(const mission::Mission& mission, const mission::Fault& fault) {
  constexpr std::int32_t kAll = ~std::int32_t{0};
  switch (fault.kind) {
    case FaultKind::kThrustScale:
    case FaultKind::kThrustUncommanded:
      return 0;
    case FaultKind::kComputerSilent:
    case FaultKind::kComputerReboot:
    case FaultKind::kAttitudeError:
      return kAll;
    default:
      break;
  }
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (spacecraft.name != fault.spacecraft) continue;
    // What the other spacecraft sends serves the pair only.
    if (!spacecraft.flight_computer) return vbar::navigation_configuration::kUseCarrierPair;
    for (const mission::Sensor& sensor : spacecraft.sensors)
      if (sensor.name == fault.unit) return sensor.settings->navigation;
  }
  return 0;
}

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
