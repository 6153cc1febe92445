#include "host_sim/cli/replay_input.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "host_sim/report/provenance.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::app {

namespace {

constexpr auto kFirstWord = "vbar-snapshot";

}  // namespace

void write_snapshot(const std::filesystem::path& file, const Snapshot& snapshot) {
  std::ofstream out(file, std::ios::binary);
  out << kFirstWord << ' ' << snapshot.next_step << ' ' << snapshot.bytes.size() << '\n';
  out.write(reinterpret_cast<const char*>(snapshot.bytes.data()), static_cast<std::streamsize>(snapshot.bytes.size()));
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", file.string()));
}

Snapshot read_snapshot(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Refused(fmt::format("{}: cannot be read", file.string()));
  std::string line;
  std::getline(in, line);
  std::istringstream words(line);
  std::string first;
  std::size_t size = 0;
  Snapshot snapshot;
  if (!(words >> first >> snapshot.next_step >> size) || first != kFirstWord)
    throw Refused(fmt::format("{}: is no snapshot (vbar replay --save writes one)", file.string()));
  snapshot.bytes.assign(std::istreambuf_iterator<char>(in), {});
  if (snapshot.bytes.size() != size)
    throw Refused(fmt::format("{}: {} bytes of {}", file.string(), snapshot.bytes.size(), size));
  return snapshot;
}

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
