#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

constexpr double kDegree = M_PI / 180.0;
/// Smallest jump lies above the second differences of pseudoranges in orbit, by which the observer of the fault detects
/// it.
constexpr double kShortestClockJump_s = 1e-6;

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

/// A receiver that this program simulates.
void read_digital_receiver(const TableReader& section, const Mission& mission, Fault& fault) {
  const Sensor& sensor = read_unit(section, mission, fault, {"gnss"});
  if (sensor.settings->source != "digital")
    section.refuse_value("unit", "a receiver with source = \"digital\": that of " + sensor.settings->source +
                                     " does not fail on request");
}

bool uses_carrier_phase(const Spacecraft& spacecraft) {
  return std::ranges::any_of(spacecraft.sensors, [](const Sensor& sensor) {
    return (sensor.settings->navigation & vbar::navigation_configuration::kUseCarrierPair) != 0;
  });
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// `event`, an alternative to `at_h`. Waypoints have times that are known.
void read_event(const TableReader& section, const Mission& mission, Fault& fault) {
  using Kind = FaultEvent::Kind;
  fault.start = section.text("event");
  const fsw::Duration delay = section.span("after_s", 1.0, from_to(0.0, 1e7), 0.0);
  const std::string_view text = fault.start;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view kind = text.substr(0, colon);
  const std::string_view argument = text.substr(std::min(colon + 1, text.size()));
  const auto await = [&](Kind event, double number) {
    fault.awaited = FaultEvent{event, number, delay};
    fault.begin = Fault::kNever;
  };
  if (text == "first_fix") {
    if (!uses_carrier_phase(flying(section, mission)))
      section.refuse_value("event", "first_fix only in a mission that navigates by carrier phase");
    return await(Kind::kFirstFix, 0.0);
  }
  if (const auto index = number_in<int>(argument); kind == "waypoint" && index) {
    const Waypoint* const waypoint = mission.find_waypoint(*index);
    if (waypoint == nullptr || waypoint->time < mission.start_time() || waypoint->time + delay > mission.end_time())
      section.refuse_value("event", "a waypoint of the run");
    fault.begin = waypoint->time + delay;
    return;
  }
  if (const auto number = number_in<int>(argument); kind == "burn" && number && *number >= 1)
    return await(Kind::kBurn, *number);
  if (const auto range = number_in<double>(argument);
      kind == "range_below_m" && range && *range > 0.0 && std::isfinite(*range))
    return await(Kind::kRangeBelow, *range);
  section.refuse_value("event", "first_fix, waypoint:N, burn:N with N from 1 on, or range_below_m:X with X above 0");
}

void read_begin(const TableReader& section, const Mission& mission, Fault& fault) {
  if (section.has("event") && section.has("at_h")) section.refuse("event", "a second start", "at_h or event, not both");
  if (section.has("event")) return read_event(section, mission, fault);
  fault.begin = mission.epoch + section.span("at_h", kHour_s, from_to(0.0, kLongestMission_h));
  if (fault.begin < mission.start_time() || fault.begin > mission.end_time())
    section.refuse_value("at_h", "a time of the run");
}

std::string read_satellite(const TableReader& section) {
  std::string satellite = section.text("satellite", "highest");
  const bool is_number = satellite.size() == 3 &&
                         std::string_view("GEC").find(satellite[0]) != std::string_view::npos &&
                         number_in<unsigned>(std::string_view(satellite).substr(1)).value_or(0) > 0;
  if (satellite != "highest" && satellite != "all" && !is_number)
    section.refuse_value("satellite", "highest, all, or a satellite by letter and two digits: G05, E11, C03");
  return satellite;
}

/// What happens at an instant has no duration.
void refuse_duration(const TableReader& section, Fault& fault) {
  if (fault.duration) section.refuse_value("for_s", "no duration: it jumps once");
  fault.duration = fsw::Duration{0};
}

Fault read_fault(const TableReader& section, const Mission& mission) {
  Fault fault;
  fault.kind = section.choice<FaultKind>("kind", kFaultKinds);
  fault.name = section.text("name", std::string(name_of(fault.kind)));
  read_begin(section, mission, fault);
  if (section.has("for_s")) fault.duration = section.span("for_s", 1.0, above_to(0.0, 1e7));
  switch (fault.kind) {
    case FaultKind::kCycleSlip:
      read_digital_receiver(section, mission, fault);
      fault.satellite = read_satellite(section);
      fault.value = static_cast<double>(section.integer("value_cycles", -1000, 1000));
      if (fault.value == 0.0) section.refuse_value("value_cycles", "an integer that is not 0");
      refuse_duration(section, fault);
      break;
    case FaultKind::kClockJump:
      read_digital_receiver(section, mission, fault);
      fault.value = section.number("value_s", from_to(-1e-2, 1e-2));
      if (std::abs(fault.value) < kShortestClockJump_s) section.refuse_value("value_s", "1e-6 or more, of either sign");
      refuse_duration(section, fault);
      break;
    case FaultKind::kReceiverReset:
      read_digital_receiver(section, mission, fault);
      if (!fault.duration) fault.duration = fsw::Duration{0};
      break;
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
    case FaultKind::kTargetHidden:
      fault.observed = read_unit(section, mission, fault, {"camera"}).settings->observed;
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
