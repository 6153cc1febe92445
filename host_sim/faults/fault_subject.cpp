#include "host_sim/faults/fault_subject.h"

#include <string>

namespace vbar::faults {

using fsw::packets::Apid;
using mission::FaultKind;

namespace {

/// The messages of a camera, a receiver, a star tracker and a range finder, by the words of their sensor's kind.
std::optional<Apid> message_of(const mission::Mission& mission, const mission::Fault& fault) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (spacecraft.name != fault.spacecraft) continue;
    for (const mission::Sensor& sensor : spacecraft.sensors) {
      if (sensor.name != fault.unit) continue;
      if (sensor.kind == "camera") return Apid::kImageTile;
      if (sensor.kind == "gnss") return spacecraft.flight_computer ? Apid::kGnssBytes : Apid::kCrosslinkGnssBytes;
      if (sensor.kind == "range_finder") return Apid::kRangeMeasurement;
      return Apid::kIdealNavigation;
    }
  }
  return std::nullopt;
}

/// Header unit of a camera: cameras for navigation are numbered in the order of the sensors.
std::uint8_t unit_of(const mission::Mission& mission, const std::string& name) {
  std::uint8_t unit = 0;
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (!spacecraft.flight_computer) continue;
    for (const mission::Sensor& sensor : spacecraft.sensors) {
      if (sensor.name == name) return unit;
      if (sensor.kind == "camera" && sensor.settings->navigation != 0) ++unit;
    }
  }
  return 0;
}

}  // namespace

std::optional<StreamKey> stream_of(const mission::Mission& mission, const mission::Fault& fault) {
  const auto apid = message_of(mission, fault);
  if (!apid) return std::nullopt;
  return StreamKey{*apid, *apid == Apid::kImageTile ? unit_of(mission, fault.unit) : std::uint8_t{0}};
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
