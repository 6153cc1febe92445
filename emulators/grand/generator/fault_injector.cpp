#include "emulators/grand/generator/fault_injector.h"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace vbar::grand::bench {
namespace {

using fsw::Duration;

std::uint64_t count_of(const Fault& fault) {
  return static_cast<std::uint64_t>(fault.value);
}

GeneratorEngine::SampleFault sample_fault(FaultKind kind) {
  if (kind == FaultKind::kSamplesDoubled) return GeneratorEngine::SampleFault::kDoubled;
  if (kind == FaultKind::kSamplesSwapped) return GeneratorEngine::SampleFault::kSwapped;
  return GeneratorEngine::SampleFault::kLost;
}

/// Returns the kind of impairment of a line's fault.
LineImpairment::Kind impairment(FaultKind kind) {
  switch (kind) {
    case FaultKind::kLineHalfMessages:
      return LineImpairment::kHalfMessages;
    case FaultKind::kLineFlood:
      return LineImpairment::kFlood;
    case FaultKind::kReceiverUnanswered:
      return LineImpairment::kUnanswered;
    case FaultKind::kReceiverRefuses:
      return LineImpairment::kRefuses;
    default:
      return LineImpairment::kGarbage;
  }
}

std::string serial_config(std::size_t port, unsigned baud) {
  return fmt::format("SERIALCONFIG COM{} {} N 8 1 N OFF\r\n", port + 1, baud);
}

}  // namespace

FaultInjector::FaultInjector(GeneratorEngine& engine, ControlServers& control, EdgeBroadcaster& edges,
                             const std::filesystem::path& file)
    : engine_(&engine), control_(&control), edges_(&edges), log_(file) {}

void FaultInjector::add(const Fault& fault, Acknowledge acknowledge) {
  active_.push_back({fault, std::move(acknowledge)});
}

void FaultInjector::advance() {
  for (Active& active : active_) {
    const bool is_due = !active.fault.time || (engine_->time() && time_for(active.fault) >= *active.fault.time);
    if (!active.has_begun && is_due) begin(active);
    if (!active.has_begun) continue;
    if (!active.has_effect && has_effect(active)) acknowledge(active);
    const Duration duration = active.fault.duration;
    if (!active.has_ended && duration.ns > 0 && time_for(active.fault).ns - active.begun.ns >= duration.ns) end(active);
  }
  std::erase_if(active_, [](const Active& active) { return active.has_effect && active.has_ended; });
}

// A generator that has died has no time of its own.
Duration FaultInjector::time_for(const Fault& fault) const {
  if (fault.kind == FaultKind::kGeneratorDies && !engine_->time())
    return {std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1)};
  const FaultRule& rule = rule_of(fault.kind);
  return (rule.has_vehicle ? engine_->time_of(fault.vehicle) : engine_->time()).value_or(Duration{});
}

void FaultInjector::begin(Active& active) {
  const Fault& fault = active.fault;
  active.has_begun = true;
  active.begun = time_for(fault);
  active.count = effect_count(fault);
  Vehicle& vehicle = engine_->vehicle(fault.vehicle);
  const auto baud = static_cast<unsigned>(fault.value);
  switch (fault.kind) {
    case FaultKind::kLineHangUp:
      vehicle.ports()[fault.port].line->hang_up();
      break;
    case FaultKind::kLineGarbage:
    case FaultKind::kLineHalfMessages:
    case FaultKind::kLineFlood:
    case FaultKind::kReceiverUnanswered:
    case FaultKind::kReceiverRefuses:
      set_line_fault(fault, true);
      break;
    case FaultKind::kReceiverBaud: {
      const std::string command = serial_config(fault.port, baud);
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(command.data());
      vehicle.receiver().listen(fault.port, {bytes, command.size()}, vehicle.receiver().baud(fault.port));
      break;
    }
    case FaultKind::kHostBaud:
      vehicle.ports()[fault.port].line->set_host_baud(baud);
      break;
    case FaultKind::kReceiverOff:
      vehicle.receiver().power(false);
      break;
    case FaultKind::kRfOutage:
      vehicle.set_outage(true);
      break;
    case FaultKind::kCn0Drop:
      vehicle.receiver().set_cn0_offset_db(-fault.value);
      break;
    case FaultKind::kGeneratorError:
      engine_->fail(fault.text);
      break;
    case FaultKind::kGeneratorDies:
      engine_->stop();
      active.begun = time_for(fault);
      set_control_faults();
      control_->close_connections();
      break;
    case FaultKind::kGeneratorRefuses:
    case FaultKind::kGeneratorUnanswered:
      set_control_faults();
      break;
    case FaultKind::kPpsMissing:
      edges_->miss(static_cast<unsigned>(count_of(fault)));
      break;
    case FaultKind::kPpsDoubled:
      edges_->repeat(static_cast<unsigned>(count_of(fault)));
      break;
    case FaultKind::kPpsJump:
      edges_->jump(fsw::nearest_duration(fault.value));
      break;
    case FaultKind::kPpsDelay:
      edges_->delay(fsw::nearest_duration(fault.value));
      break;
    case FaultKind::kSamplesLost:
    case FaultKind::kSamplesDoubled:
    case FaultKind::kSamplesSwapped:
      engine_->damage_samples(fault.vehicle, sample_fault(fault.kind), count_of(fault));
      break;
    case FaultKind::kBenchExit:
      break;
  }
  active.has_ended = !rule_of(fault.kind).has_duration || fault.duration.ns == 0;
}

void FaultInjector::end(Active& active) {
  const Fault& fault = active.fault;
  active.has_ended = true;
  Vehicle& vehicle = engine_->vehicle(fault.vehicle);
  switch (fault.kind) {
    case FaultKind::kLineHangUp:
      vehicle.ports()[fault.port].line->plug_in();
      break;
    case FaultKind::kReceiverOff:
      vehicle.receiver().power(true);
      break;
    case FaultKind::kRfOutage:
      vehicle.set_outage(false);
      break;
    case FaultKind::kCn0Drop:
      vehicle.receiver().set_cn0_offset_db(0.0);
      break;
    case FaultKind::kGeneratorDies:
      engine_->reset();
      set_control_faults();
      break;
    case FaultKind::kGeneratorRefuses:
    case FaultKind::kGeneratorUnanswered:
      set_control_faults();
      break;
    default:
      set_line_fault(fault, false);
      break;
  }
}

// Counter of the effect of a fault; a fault that acts at once has none.
std::uint64_t FaultInjector::effect_count(const Fault& fault) const {
  Vehicle& vehicle = engine_->vehicle(fault.vehicle);
  switch (fault.kind) {
    case FaultKind::kLineGarbage:
    case FaultKind::kLineHalfMessages:
    case FaultKind::kLineFlood:
    case FaultKind::kReceiverUnanswered:
    case FaultKind::kReceiverRefuses:
      return vehicle.ports()[fault.port].impairment.count(impairment(fault.kind));
    case FaultKind::kReceiverOff:
    case FaultKind::kRfOutage:
    case FaultKind::kCn0Drop:
      return static_cast<std::uint64_t>(vehicle.blocks_end().ns);
    case FaultKind::kGeneratorRefuses:
    case FaultKind::kGeneratorUnanswered:
      return control_->statistics().faults_applied;
    case FaultKind::kPpsMissing:
    case FaultKind::kPpsDoubled:
    case FaultKind::kPpsJump:
    case FaultKind::kPpsDelay:
      return engine_->edges_sent();
    case FaultKind::kSamplesLost:
    case FaultKind::kSamplesDoubled:
    case FaultKind::kSamplesSwapped:
      return engine_->damaged_samples(fault.vehicle);
    default:
      return 0;
  }
}

bool FaultInjector::has_effect(const Active& active) const {
  const Fault& fault = active.fault;
  switch (fault.kind) {
    case FaultKind::kReceiverBaud:
      return engine_->vehicle(fault.vehicle).receiver().baud(fault.port) == static_cast<unsigned>(fault.value);
    case FaultKind::kLineHangUp:
    case FaultKind::kHostBaud:
    case FaultKind::kGeneratorError:
    case FaultKind::kGeneratorDies:
    case FaultKind::kBenchExit:
      return true;
    default:
      return effect_count(fault) > active.count;
  }
}

void FaultInjector::acknowledge(Active& active) {
  const Fault& fault = active.fault;
  const FaultRule& rule = rule_of(fault.kind);
  active.has_effect = true;
  nlohmann::ordered_json line{{"kind", rule.name}};
  if (const auto time = rule.has_vehicle ? engine_->time_of(fault.vehicle) : engine_->time())
    line["time_s"] = fsw::seconds(*time);
  if (rule.has_vehicle) line["vehicle"] = engine_->vehicle(fault.vehicle).name();
  if (rule.has_port) line["port"] = fault.port + 1;
  if (rule.has_duration) line["duration_s"] = fsw::seconds(fault.duration);
  if (!rule.value_key.empty()) line[std::string(rule.value_key)] = fault.value;
  if (!rule.text_key.empty()) line[std::string(rule.text_key)] = fault.text;
  log_.write(line.dump(), active.acknowledge);
  if (fault.kind == FaultKind::kBenchExit && on_exit) on_exit();
}

void FaultInjector::set_line_fault(const Fault& fault, bool is_on) {
  engine_->vehicle(fault.vehicle).ports()[fault.port].impairment.set(impairment(fault.kind), is_on);
}

void FaultInjector::set_control_faults() {
  ControlFaults faults;
  for (const Active& active : active_) {
    if (!active.has_begun || active.has_ended) continue;
    if (active.fault.kind == FaultKind::kGeneratorRefuses) faults.refused_command = active.fault.text;
    if (active.fault.kind == FaultKind::kGeneratorUnanswered) faults.unanswered_command = active.fault.text;
    if (active.fault.kind == FaultKind::kGeneratorDies) faults.is_silent = faults.refuses_connections = true;
  }
  control_->set_faults(faults);
}

}  // namespace vbar::grand::bench
