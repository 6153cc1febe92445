#include "emulators/optical_stimulator/faults.h"

#include "emulators/common/control_line.h"

namespace vbar::optical_stimulator::bench {
namespace {

using mission::from_to;
using mission::TableReader;

constexpr const char* kControlLine = "fault control line";
constexpr std::int64_t kAxes = 2;

}  // namespace

Fault read_fault(const TableReader& section) {
  constexpr std::int64_t kMaxFrames = 1'000'000'000;
  const FaultRule& rule = emulators::read_fault_rule(section, kFaultRules);
  Fault fault;
  fault.kind = rule.kind;
  if (section.has("frame")) fault.frame = static_cast<std::uint64_t>(section.integer("frame", 0, kMaxFrames));
  if (rule.span == FaultSpan::kFrames)
    fault.frames = static_cast<std::uint64_t>(section.integer("frames", 0, kMaxFrames, 0));
  if (rule.span == FaultSpan::kSeconds) fault.duration_s = section.number("duration_s", from_to(0.0, 1e6), 0.0);
  if (rule.has_axis) fault.axis = static_cast<std::size_t>(section.integer("axis", 1, kAxes) - 1);
  if (!rule.value_key.empty()) fault.value = section.number(rule.value_key, rule.value_range);
  if (!rule.second_key.empty()) fault.second = section.number(rule.second_key, rule.value_range, 0.0);
  section.finish();
  return fault;
}

Fault fault_from_json(const std::string& line) {
  const toml::table table = emulators::table_of_json(line, kControlLine, R"({"kind": "late_frame", "frames": 1})");
  return read_fault(TableReader(table, kControlLine));
}

}  // namespace vbar::optical_stimulator::bench
