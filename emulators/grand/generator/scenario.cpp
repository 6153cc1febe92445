#include "emulators/grand/generator/scenario.h"

#include <algorithm>

#include "emulators/common/control_line.h"
#include "emulators/grand/receiver/serial_line.h"
#include "hil_drivers/grand/wire/template_format.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/sensors/settings/gnss_tables.h"

namespace vbar::grand::bench {

namespace {

using mission::from_to;
using mission::TableReader;

constexpr const char* kControlLine = "fault control line";
constexpr std::int64_t kPorts = 2;

std::size_t read_vehicle(const TableReader& section, const std::vector<std::string>& vehicles) {
  const std::string name = section.text("vehicle");
  const auto found = std::ranges::find(vehicles, name);
  if (found == vehicles.end()) section.refuse_value("vehicle", mission::listing_of({vehicles.begin(), vehicles.end()}));
  return static_cast<std::size_t>(found - vehicles.begin());
}

}  // namespace

Fault read_fault(const TableReader& section, const std::vector<std::string>& vehicles) {
  const FaultRule& rule = emulators::read_fault_rule(section, kFaultRules);
  Fault fault;
  fault.kind = rule.kind;
  if (section.has("time_s")) fault.time = section.span("time_s", 1.0, from_to(0.0, 1e7));
  if (rule.has_vehicle) fault.vehicle = read_vehicle(section, vehicles);
  if (rule.has_port) fault.port = static_cast<std::size_t>(section.integer("port", 1, kPorts, 1) - 1);
  if (rule.has_duration) fault.duration = section.span("duration_s", 1.0, from_to(0.0, 1e7), 0.0);
  if (!rule.value_key.empty()) {
    fault.value = section.number(rule.value_key, rule.value_range);
    if (rule.value_key == "baud" && !is_baud_rate(static_cast<unsigned>(fault.value)))
      section.refuse_value("baud", "a rate of the receiver: 2400, 4800, 9600, 19200, ... 460800");
  }
  if (!rule.text_key.empty()) fault.text = section.text(rule.text_key);
  section.finish();
  return fault;
}

Fault fault_from_json(const std::string& line, const std::vector<std::string>& vehicles) {
  const toml::table table =
      emulators::table_of_json(line, kControlLine, R"({"kind": "rf_outage", "vehicle": "target"})");
  return read_fault(TableReader(table, kControlLine), vehicles);
}

namespace {

using mission::Names;
using mission::Range;

constexpr Names<Pace, 2> kPaces{{{"lock_step", Pace::kLockStep}, {"real_time", Pace::kRealTime}}};
constexpr Names<ControlProtocol, 3> kProtocols{{{"skydel", ControlProtocol::kSkydel},
                                                {"simgen", ControlProtocol::kSimgen},
                                                {"template", ControlProtocol::kTemplate}}};

/// Key in milliseconds.
void read_ms(const TableReader& section, std::string_view key, Range range, fsw::Duration& value) {
  value = section.span(key, 1e-3, range, fsw::seconds(value) * 1e3);
}

std::vector<std::uint16_t> read_ports(const TableReader& section, std::string_view key) {
  std::vector<std::uint16_t> ports;
  if (!section.has(key)) return ports;
  for (const double port : section.numbers(key, 0, 16, from_to(0.0, 65535.0)))
    ports.push_back(static_cast<std::uint16_t>(port));
  return ports;
}

void read_generator(const TableReader& section, Scenario& scenario) {
  ControlSettings& control = scenario.control;
  control.protocol = section.choice<ControlProtocol>("protocol", kProtocols, control.protocol);
  control.control_ports = read_ports(section, "control_ports");
  control.hil_ports = read_ports(section, "hil_ports");
  read_ms(section, "engine_latency_ms", from_to(0.0, 1000.0), scenario.engine_latency);
  control.engine_latency_ms = static_cast<std::uint32_t>(scenario.engine_latency.ns / 1'000'000);
  read_ms(section, "join_ms", from_to(1.0, 10'000.0), scenario.join);
  scenario.start_shift = section.span("start_shift_s", 1.0, from_to(-1e4, 1e4), 0.0);
  if (control.protocol == ControlProtocol::kTemplate)
    control.template_format = wire::read_template_format(section.table("template"));
  section.finish();
}

void read_box(const TableReader& section, BoxErrorSettings& box) {
  read(section, "carrier_alignment_mm", from_to(0.0, 100.0), box.carrier_alignment_mm);
  read(section, "code_alignment_mm", from_to(0.0, 1e4), box.code_alignment_mm);
  read(section, "channel_phase_mm", from_to(0.0, 100.0), box.channel_phase_mm);
  read(section, "channel_phase_time_s", from_to(0.5, 1e5), box.channel_phase_time_s);
  section.finish();
}

void read_sky(const TableReader& document, SkySettings& sky) {
  const TableReader visibility = document.table("visibility");
  sensors::read_visibility(visibility, sky.visibility);
  visibility.finish();
  const TableReader link_budget = document.table("link_budget");
  sensors::read_link_budget(link_budget, sky.link_budget);
  link_budget.finish();
  sky.ionosphere = document.flag("ionosphere", sky.ionosphere);
  read_box(document.table("bench"), sky.box);
}

VehicleScenario read_vehicle(const TableReader& section) {
  VehicleScenario vehicle;
  vehicle.name = section.name("name");
  vehicle.com_ports = static_cast<std::size_t>(section.integer("com_ports", 1, 2, 2));
  const TableReader receiver = section.table("receiver");
  vehicle.receiver = read_receiver_settings(receiver);
  section.finish();
  return vehicle;
}

std::vector<VehicleScenario> read_vehicles(const TableReader& document) {
  std::vector<VehicleScenario> vehicles;
  for (TableReader& section : document.tables("vehicle")) {
    vehicles.push_back(read_vehicle(section));
    const auto same = [&](const VehicleScenario& other) { return other.name == vehicles.back().name; };
    if (std::ranges::count_if(vehicles, same) > 1) section.refuse_value("name", "a name that no other vehicle has");
  }
  if (vehicles.empty() || vehicles.size() > 8)
    document.refuse("vehicle", std::to_string(vehicles.size()) + " tables", "1 to 8 tables [[vehicle]]");
  return vehicles;
}

}  // namespace

std::vector<std::string> Scenario::vehicle_names() const {
  std::vector<std::string> names;
  for (const VehicleScenario& vehicle : vehicles) names.push_back(vehicle.name);
  return names;
}

Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  toml::table table = mission::parse_toml(mission::read_text_file(file, "a scenario file (TOML)"), file.string());
  for (const std::string& assignment : assignments) mission::apply_override(table, assignment);
  const TableReader document(table, file.string());
  Scenario scenario;
  scenario.seed = static_cast<std::uint64_t>(document.integer("seed", 0, INT64_MAX, 1));
  scenario.pace = document.choice<Pace>("pace", kPaces, scenario.pace);
  read(document, "speed_factor", from_to(0.1, 100.0), scenario.speed_factor);
  read_generator(document.table("generator"), scenario);
  const TableReader pps = document.table("pps");
  read(pps, "jitter_ns", from_to(0.0, 1e7), scenario.pps_jitter_ns);
  pps.finish();
  sensors::read_constellation(document.table("constellation"), scenario.constellation);
  read_sky(document, scenario.sky);
  scenario.vehicles = read_vehicles(document);
  for (const TableReader& section : document.tables("fault"))
    scenario.faults.push_back(read_fault(section, scenario.vehicle_names()));
  document.finish();
  return scenario;
}

}  // namespace vbar::grand::bench
