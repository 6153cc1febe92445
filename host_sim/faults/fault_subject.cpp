#include "host_sim/faults/fault_subject.h"

#include "host_sim/sensors/sensor_kinds.h"

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

}  // namespace vbar::faults
