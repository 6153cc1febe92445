#include "emulators/tron/faults.h"

#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "emulators/common/control_line.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/mission/mission.h"
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
  const toml::table table = emulators::table_of_json(line, where, kExample);
  return read_fault(TableReader(table, where));
}

}  // namespace

Fault read_fault(const TableReader& section) {
  const FaultRule& rule = emulators::read_fault_rule(section, kFaultRules);
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

FaultList::FaultList(Act act, const std::filesystem::path& file) : act_(std::move(act)), log_(file) {}

void FaultList::add(const Fault& fault, double now_s, emulators::Acknowledge acknowledge) {
  entries_.push_back({fault, std::move(acknowledge)});
  step(entries_.back(), now_s);
}

void FaultList::begin_cycle(std::uint64_t cycle, double now_s) {
  cycle_ = cycle;
  advance(now_s);
}

void FaultList::end_exposure(std::uint64_t image, double now_s) {
  take_effect(FaultEffect::kExposure);
  image_ = image + 1;
  advance(now_s);
}

void FaultList::vicon_frame_sent() {
  take_effect(FaultEffect::kViconFrame);
}

void FaultList::advance(double now_s) {
  for (Entry& entry : entries_) step(entry, now_s);
}

void FaultList::step(Entry& entry, double now_s) {
  if (entry.phase == Phase::kWaiting && is_due(entry.fault)) {
    entry.phase = Phase::kDue;
    entry.due_cycle = cycle_;
  }
  if (entry.phase == Phase::kDue && cycle_ >= entry.due_cycle + entry.fault.after_cycles) begin(entry, now_s);
  if (entry.phase == Phase::kActive && is_over(entry, now_s)) end(entry);
}

bool FaultList::is_due(const Fault& fault) const {
  if (fault.at_image) return image_ >= *fault.at_image;
  if (fault.at_cycle) return cycle_ >= *fault.at_cycle;
  return true;
}

bool FaultList::is_over(const Entry& entry, double now_s) const {
  const Fault& fault = entry.fault;
  switch (rule_of(fault.kind).span) {
    case FaultSpan::kOnce:
      return true;
    case FaultSpan::kImages:
      return fault.images > 0 && image_ >= entry.begun_image + fault.images;
    case FaultSpan::kCycles:
      return fault.cycles > 0 && cycle_ >= entry.begun_cycle + fault.cycles;
    case FaultSpan::kSeconds:
      return fault.duration_s > 0.0 && now_s >= entry.begun_s + fault.duration_s;
  }
  return true;
}

void FaultList::begin(Entry& entry, double now_s) {
  entry.phase = Phase::kActive;
  entry.begun_cycle = cycle_;
  entry.begun_image = image_;
  entry.begun_s = now_s;
  if (rule_of(entry.fault.kind).effect == FaultEffect::kAtOnce) acknowledge(entry);
  act_(entry.fault, true);
}

void FaultList::end(Entry& entry) {
  entry.phase = Phase::kOver;
  if (rule_of(entry.fault.kind).span != FaultSpan::kOnce) act_(entry.fault, false);
}

void FaultList::take_effect(FaultEffect effect) {
  for (Entry& entry : entries_)
    if (entry.phase == Phase::kActive && !entry.is_acknowledged && rule_of(entry.fault.kind).effect == effect)
      acknowledge(entry);
}

void FaultList::acknowledge(Entry& entry) {
  entry.is_acknowledged = true;
  const FaultRule& rule = rule_of(entry.fault.kind);
  nlohmann::ordered_json line;
  line["kind"] = rule.name;
  line["image"] = image_;
  line["cycle"] = cycle_;
  if (rule.subject_key == "box")
    line["box"] = entry.fault.box + 1;
  else if (!rule.subject_key.empty())
    line[std::string(rule.subject_key)] = entry.fault.is_of_target ? "target" : "camera";
  if (!rule.value_key.empty()) line[std::string(rule.value_key)] = entry.fault.value;
  log_.write(line.dump(), entry.acknowledge);
}

}  // namespace vbar::tron::bench
