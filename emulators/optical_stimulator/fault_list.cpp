#include "emulators/optical_stimulator/fault_list.h"

#include <utility>

#include <nlohmann/json.hpp>

namespace vbar::optical_stimulator::bench {
namespace {

bool is_of_exposure(FaultKind kind) {
  return rule_of(kind).span == FaultSpan::kFrames;
}

void apply(const Fault& fault, ExposureFaults& faults) {
  switch (fault.kind) {
    case FaultKind::kLateFrame:
      faults.panel.is_late = true;
      break;
    case FaultKind::kFrozenDisplay:
      faults.panel.is_frozen = true;
      break;
    case FaultKind::kCoveredDisplay:
      faults.panel.is_covered = true;
      break;
    case FaultKind::kMirroredDisplay:
      faults.panel.is_mirrored = true;
      break;
    case FaultKind::kRotatedDisplay:
      faults.panel.is_rotated = true;
      break;
    case FaultKind::kExposure:
      faults.exposure_factor *= fault.value;
      break;
    case FaultKind::kGain:
      faults.gain_factor *= fault.value;
      break;
    case FaultKind::kBrightness:
      faults.brightness_factor *= fault.value;
      break;
    case FaultKind::kCameraAway:
    case FaultKind::kCameraBusy:
    case FaultKind::kPacketLoss:
    case FaultKind::kPacketsDoubled:
    case FaultKind::kPacketsReordered:
    case FaultKind::kAnswersLate:
    case FaultKind::kXmlDamaged:
    case FaultKind::kRegionRefused:
    case FaultKind::kTriggersIgnored:
    case FaultKind::kBumped:
    case FaultKind::kRailStalled:
    case FaultKind::kRailMoved:
    case FaultKind::kBenchExit:
      break;
  }
}

}  // namespace

FaultList::FaultList(FaultActions actions, const std::filesystem::path& file)
    : actions_(std::move(actions)), log_(file) {}

void FaultList::add(const Fault& fault, double now_s, Acknowledge acknowledge) {
  active_.push_back({fault, std::move(acknowledge)});
  if (!fault.frame || *fault.frame < next_frame_) begin(active_.back(), next_frame_, now_s);
  advance(now_s);
}

void FaultList::begin(Active& active, std::uint64_t frame, double now_s) {
  active.has_begun = true;
  active.begun_frame = frame;
  active.begun_s = now_s;
  if (active.fault.kind == FaultKind::kRailStalled) active.stalls_before = actions_.rail_stalls(active.fault.axis);
  act(active.fault, true);
  // Those of an exposure are acknowledged after it, a stalled rail when a move has stalled; all others act at once.
  if (!is_of_exposure(active.fault.kind) && active.fault.kind != FaultKind::kRailStalled)
    this->acknowledge(active, frame);
  if (active.fault.kind == FaultKind::kBenchExit) actions_.exit();
}

void FaultList::act(const Fault& fault, bool is_on) {
  switch (fault.kind) {
    case FaultKind::kCameraAway:
    case FaultKind::kCameraBusy:
    case FaultKind::kPacketLoss:
    case FaultKind::kPacketsDoubled:
    case FaultKind::kPacketsReordered:
    case FaultKind::kAnswersLate:
    case FaultKind::kXmlDamaged:
    case FaultKind::kRegionRefused:
    case FaultKind::kTriggersIgnored:
      actions_.camera(fault, is_on);
      break;
    case FaultKind::kBumped:
      actions_.bump(fault.value, fault.second);
      break;
    case FaultKind::kRailStalled:
      actions_.stall_rail(fault.axis);
      break;
    case FaultKind::kRailMoved:
      actions_.move_rail(fault.axis, fault.value);
      break;
    case FaultKind::kLateFrame:
    case FaultKind::kFrozenDisplay:
    case FaultKind::kCoveredDisplay:
    case FaultKind::kMirroredDisplay:
    case FaultKind::kRotatedDisplay:
    case FaultKind::kExposure:
    case FaultKind::kGain:
    case FaultKind::kBrightness:
    case FaultKind::kBenchExit:
      break;
  }
}

ExposureFaults FaultList::begin_exposure(std::uint64_t frame, double now_s) {
  next_frame_ = frame + 1;
  ExposureFaults faults;
  for (Active& active : active_) {
    if (!active.has_begun && active.fault.frame && frame >= *active.fault.frame) begin(active, frame, now_s);
    if (!active.has_begun || active.has_ended || !is_of_exposure(active.fault.kind)) continue;
    if (active.fault.frames != 0 && frame >= active.begun_frame + active.fault.frames) {
      active.has_ended = true;
      continue;
    }
    apply(active.fault, faults);
  }
  return faults;
}

void FaultList::end_exposure(std::uint64_t frame) {
  for (Active& active : active_)
    if (active.has_begun && !active.has_ended && !active.is_acknowledged && is_of_exposure(active.fault.kind))
      acknowledge(active, frame);
}

void FaultList::advance(double now_s) {
  for (Active& active : active_) {
    if (!active.has_begun || active.has_ended) continue;
    const Fault& fault = active.fault;
    if (fault.kind == FaultKind::kRailStalled && actions_.rail_stalls(fault.axis) > active.stalls_before) {
      active.has_ended = true;
      acknowledge(active, next_frame_);
    }
    const bool is_over = fault.duration_s > 0.0 && now_s >= active.begun_s + fault.duration_s;
    if (rule_of(fault.kind).span == FaultSpan::kSeconds && is_over) {
      active.has_ended = true;
      act(fault, false);
    }
  }
}

void FaultList::acknowledge(Active& active, std::uint64_t frame) {
  active.is_acknowledged = true;
  const FaultRule& rule = rule_of(active.fault.kind);
  nlohmann::ordered_json line;
  line["kind"] = rule.name;
  line["frame"] = frame;
  if (rule.has_axis) line["axis"] = active.fault.axis + 1;
  if (!rule.value_key.empty()) line[std::string(rule.value_key)] = active.fault.value;
  if (!rule.second_key.empty()) line[std::string(rule.second_key)] = active.fault.second;
  log_.write(line.dump(), active.acknowledge);
}

}  // namespace vbar::optical_stimulator::bench
