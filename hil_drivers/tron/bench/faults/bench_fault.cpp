#include "hil_drivers/tron/bench/faults/bench_fault.h"

#include <sstream>

#include <fmt/format.h>

#include "hil_drivers/bench_lines/json_table.h"
#include "hil_drivers/tron/bench_file/bench_file.h"
#include "host_sim/mission/names.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::tron::bench {
namespace {

using mission::from_to;
using mission::TableReader;

constexpr const char* kControlLine = "fault control line";
constexpr const char* kExample = R"({"kind": "emergency_stop", "robot": "camera", "at_image": 3})";
constexpr mission::Names<bool, 2> kArms{{{"camera", false}, {"target", true}}};
constexpr std::int64_t kMost = 1'000'000'000'000;

std::uint64_t count(const TableReader& section, std::string_view key, std::int64_t low, std::int64_t default_value) {
  return static_cast<std::uint64_t>(section.integer(key, low, kMost, default_value));
}

void read_time(const TableReader& section, Fault& fault) {
  if (section.has("at_image")) fault.at_image = count(section, "at_image", 0, 0);
  if (section.has("at_cycle")) fault.at_cycle = count(section, "at_cycle", 0, 0);
  if (fault.at_image && fault.at_cycle) section.refuse_value("at_cycle", "either at_image or at_cycle");
  fault.after_cycles = count(section, "after_cycles", 0, 0);
}

void read_span(const TableReader& section, FaultSpan span, Fault& fault) {
  switch (span) {
    case FaultSpan::kOnce:
      return;
    case FaultSpan::kImages:
      fault.images = count(section, "images", 0, 0);
      return;
    case FaultSpan::kCycles:
      fault.cycles = count(section, "cycles", 0, 0);
      return;
    case FaultSpan::kSeconds:
      fault.duration_s = section.number("duration_s", from_to(0.0, 1e6), 0.0);
      return;
  }
}

void read_subject(const TableReader& section, std::string_view key, Fault& fault) {
  if (key.empty()) return;
  if (key == "box")
    fault.box = static_cast<std::size_t>(section.integer(key, 1, kBoxes) - 1);
  else
    fault.is_of_target = section.choice<bool>(key, kArms);
}

Fault fault_of_line(const std::string& line, const std::string& where) {
  const toml::table table = bench_lines::table_of_json(line, where, kExample);
  return read_fault(TableReader(table, where));
}

}  // namespace

Fault read_fault(const TableReader& section) {
  const FaultRule& rule = bench_lines::read_fault_rule(section, kFaultRules);
  Fault fault;
  fault.kind = rule.kind;
  read_time(section, fault);
  read_span(section, rule.span, fault);
  read_subject(section, rule.subject_key, fault);
  if (!rule.value_key.empty()) fault.value = section.number(rule.value_key, rule.value_range);
  section.finish();
  return fault;
}

Fault fault_from_json(const std::string& line) {
  return fault_of_line(line, kControlLine);
}

std::vector<Fault> read_fault_file(const std::filesystem::path& file) {
  std::istringstream text(mission::read_text_file(file, "a file of faults (a JSON object a line)"));
  std::vector<Fault> faults;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number)
    if (line.find_first_not_of(" \t\r") != std::string::npos)
      faults.push_back(fault_of_line(line, fmt::format("{}:{}", file.string(), number)));
  return faults;
}

}  // namespace vbar::tron::bench
