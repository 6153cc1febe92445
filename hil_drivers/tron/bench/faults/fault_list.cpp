#include "hil_drivers/tron/bench/faults/fault_list.h"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace vbar::tron::bench {

FaultList::FaultList(Act act, const std::filesystem::path& file) : act_(std::move(act)), log_(file) {}

void FaultList::add(const Fault& fault, double now_s, bench_lines::Acknowledge acknowledge) {
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
