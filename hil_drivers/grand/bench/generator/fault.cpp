#include "hil_drivers/grand/bench/generator/fault.h"

#include <algorithm>

#include "hil_drivers/bench_lines/json_table.h"
#include "hil_drivers/grand/bench/receiver/baud_rates.h"

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
  const FaultRule& rule = bench_lines::read_fault_rule(section, kFaultRules);
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
      bench_lines::table_of_json(line, kControlLine, R"({"kind": "rf_outage", "vehicle": "target"})");
  return read_fault(TableReader(table, kControlLine), vehicles);
}

}  // namespace vbar::grand::bench
