#include <algorithm>
#include <cmath>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

constexpr double kDegree = M_PI / 180.0;

const Spacecraft& flying(const TableReader& section, const Mission& mission) {
  for (const Spacecraft& spacecraft : mission.spacecraft)
    if (spacecraft.flight_computer) return spacecraft;
  section.refuse("kind", "a fault in a mission without a flight computer", "a spacecraft that flies");
}

/// The spacecraft that carries the sensor: by default the one that flies.
const Spacecraft& read_carrier(const TableReader& section, const Mission& mission) {
  const Spacecraft& servicer = flying(section, mission);
  const Spacecraft* const carrier = mission.find_spacecraft(section.text("spacecraft", servicer.name));
  if (carrier == nullptr || (carrier != &servicer && carrier->name != servicer.observes()))
    section.refuse_value("spacecraft", servicer.name + ", or the spacecraft that it observes");
  return *carrier;
}

/// A sensor, of one of `kinds` unless these are empty.
const Sensor& read_unit(const TableReader& section, const Mission& mission, Fault& fault,
                        std::initializer_list<std::string_view> kinds = {}) {
  const Spacecraft& carrier = read_carrier(section, mission);
  fault.spacecraft = carrier.name;
  fault.unit = section.text("unit");
  std::string names;
  for (const Sensor& sensor : carrier.sensors) {
    if (kinds.size() > 0 && std::ranges::find(kinds, sensor.kind) == kinds.end()) continue;
    if (sensor.name == fault.unit) return sensor;
    names += (names.empty() ? "" : ", ") + sensor.name;
  }
  section.refuse_value("unit", "a sensor of " + carrier.name +
                                   " that can fail so: " + (names.empty() ? std::string("it has none") : names));
}

Fault read_fault(const TableReader& section, const Mission& mission) {
  Fault fault;
  fault.kind = section.choice<FaultKind>("kind", kFaultKinds);
  fault.name = section.text("name", std::string(name_of(fault.kind)));
  fault.begin = mission.epoch + section.span("at_h", kHour_s, from_to(0.0, kLongestMission_h));
  if (fault.begin < mission.start_time() || fault.begin > mission.end_time())
    section.refuse_value("at_h", "a time of the run");
  if (section.has("for_s")) fault.duration = section.span("for_s", 1.0, above_to(0.0, 1e7));
  switch (fault.kind) {
    case FaultKind::kSilent:
      read_unit(section, mission, fault);
      break;
    case FaultKind::kFrozen:
      read_unit(section, mission, fault, {"camera"});
      break;
    case FaultKind::kReceiverSilent:
      read_unit(section, mission, fault, {"gnss"});
      break;
    case FaultKind::kTargetTurned:
      fault.observed = read_unit(section, mission, fault, {"camera"}).settings->observed;
      fault.value = kDegree * section.number("value_deg", above_to(0.0, 180.0));
      break;
    case FaultKind::kAttitudeError:
      read_unit(section, mission, fault, {"gnss"});
      fault.value = kDegree * section.number("value_deg", above_to(0.0, 180.0));
      break;
    case FaultKind::kThrustScale:
      fault.value = section.number("value", from_to(0.0, 10.0));
      fault.is_reported = section.flag("reported", true);
      break;
    case FaultKind::kThrustUncommanded: {
      fault.value = section.number("value_mps2", above_to(0.0, 1.0));
      const auto direction = section.three_numbers("direction_rtn", from_to(-1.0, 1.0));
      fault.direction_rtn = fsw::Vector3(direction[0], direction[1], direction[2]);
      if (!(fault.direction_rtn.norm() > 0.0)) section.refuse_value("direction_rtn", "a direction");
      fault.direction_rtn.normalize();
      fault.is_reported = section.flag("reported", true);
      if (!fault.duration) section.refuse("for_s", "a thruster stuck for ever", "the time until its valve is closed");
      break;
    }
    case FaultKind::kComputerReboot:
      fault.keeps_state = section.flag("keeps_state", false);
      if (fault.keeps_state && !flying(section, mission).flight_computer->library.empty())
        section.refuse_value("keeps_state", "false, or no flight_computer.library");
      [[fallthrough]];
    case FaultKind::kComputerSilent:
      if (!fault.duration) section.refuse("for_s", "a flight computer that stays dark", "the time until it returns");
      break;
  }
  section.finish();
  return fault;
}

}  // namespace

// Faults of the scenario: docs/faults.md.
void read_faults(const TableReader& document, Mission& mission) {
  for (const TableReader& section : document.tables("fault")) mission.faults.push_back(read_fault(section, mission));
}

}  // namespace vbar::mission
