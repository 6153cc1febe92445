#include "host_sim/app/replay_log.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/output_hash.h"

namespace vbar::app {
namespace {

/// The first step of which the log holds nothing although it holds later ones, or no input, which every step has.
std::optional<std::uint32_t> missing_step(const RecordedSteps& steps) {
  std::uint32_t expected = 0;
  for (const auto& [number, step] : steps) {
    if (number != expected || step.inputs.empty()) return expected;
    ++expected;
  }
  return std::nullopt;
}

bool has_outputs_of(const report::Summary& summary, const RecordedSteps& steps) {
  report::OutputHash hash;
  for (const auto& [number, step] : steps)
    for (const pil::Packet& packet : step.outputs) hash.add(packet);
  return hash.commands_sha256() == summary.commands_sha256 && hash.telemetry_sha256() == summary.telemetry_sha256;
}

Verdict cut(const std::string& file, const RecordedSteps& steps, std::uint64_t flown) {
  return {kCutLog, fmt::format("{}: the log is cut at its end: {} of {} steps", file, steps.size(), flown)};
}

}  // namespace

RecordedSteps steps_of(const twins::PacketLog& log) {
  RecordedSteps steps;
  for (const twins::PacketRecord& record : log.records) {
    RecordedStep& step = steps[record.step];
    if (record.to_flight) {
      step.inputs.push_back(record);
    } else {
      step.outputs.push_back(record.packet);
    }
  }
  return steps;
}

bool has_ended(const report::Summary& summary) {
  return !summary.commands_sha256.empty();
}

std::optional<Verdict> verdict_on_log(const std::filesystem::path& path, const twins::PacketLog& log,
                                      const RecordedSteps& steps, const report::Summary& summary) {
  const std::string file = path.string();
  if (log.gap) {
    return Verdict{kThinnedLog, fmt::format("{}: byte {}: records are missing: event {} follows event {}", file,
                                            log.gap->offset, log.gap->after, log.gap->before)};
  }
  if (const auto step = missing_step(steps))
    return Verdict{kThinnedLog, fmt::format("{}: records are missing: of step {}", file, *step)};
  if (log.events_at_end && log.events != *log.events_at_end) {
    return Verdict{kThinnedLog, fmt::format("{}: records are missing: {} events, its end states {}", file, log.events,
                                            *log.events_at_end)};
  }
  if (!has_ended(summary)) return std::nullopt;
  const std::uint64_t flown = summary.flight_step.count;
  if (log.records.empty() && flown > 0)
    return Verdict{kEmptyLog, fmt::format("{}: the log is empty, the run had {} steps", file, flown)};
  const auto& written = summary.provenance.packet_log;  // none in a folder of an earlier version
  if (log.cut_short || steps.size() < flown || (written && summary.complete && !log.events_at_end))
    return cut(file, steps, flown);
  if (steps.size() > flown || !has_outputs_of(summary, steps)) {
    return Verdict{kForeignLog, fmt::format("{}: the log holds other outputs than the summary states (SHA-256)", file)};
  }
  const auto now = report::digest_of(path);
  if (written && (!now || now->sha256 != written->sha256))
    return Verdict{kDamagedLog, fmt::format("{}: the log was altered after the run (SHA-256)", file)};
  return std::nullopt;
}

}  // namespace vbar::app
