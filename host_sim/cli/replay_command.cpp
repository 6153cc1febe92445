// vbar replay: the recorded packets of a run into a flight computer.

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "host_sim/cli/commands.h"
#include "host_sim/cli/recorded_flight.h"
#include "host_sim/cli/replay_input.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/recorded_mission.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/twins/lcm_log.h"

namespace vbar::app {
namespace {

void refuse_overrides_without_effect(const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) {
    if (flight_computer_key(assignment).empty())
      throw Refused("--set " + assignment + ": has no effect on a replay; accepted: keys of flight_computer");
  }
}

/// The mission as it was flown, with the overrides of then and, over them, those of now.
mission::Mission mission_as_flown(const ReplayOptions& options) {
  refuse_overrides_without_effect(options.overrides);
  std::vector<std::string> overrides = overrides_of_run(options.run_folder);
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  mission::Mission mission = sensors::load_mission(options.run_folder / kMissionCopy, overrides);
  check_trust(mission, options.run_folder, options.overrides, options.trust);
  return mission;
}

/// The packets that went to the flight software, with the image tiles restored that the log holds in another form.
std::vector<pil::Packet> packets_of(const std::vector<twins::PacketRecord>& records, twins::TileSource& tiles) {
  std::vector<pil::Packet> packets;
  for (const twins::PacketRecord& record : records) {
    if (!record.tiles) {
      packets.push_back(record.packet);
    } else {
      for (pil::Packet& tile : tiles.packets_of(*record.tiles)) packets.push_back(std::move(tile));
    }
  }
  return packets;
}

/// Returns the first difference of two answers, empty if there is none. `cut`: the recorded one may lack packets at its
/// end.
std::optional<std::string> difference(const std::vector<pil::Packet>& recorded, const std::vector<pil::Packet>& now,
                                      bool cut) {
  for (std::size_t k = 0; k < std::min(recorded.size(), now.size()); ++k) {
    const auto [a, b] = std::ranges::mismatch(recorded[k], now[k]);
    if (a == recorded[k].end() && b == now[k].end()) continue;
    return fmt::format("packet {} differs from byte {} on", k, a - recorded[k].begin());
  }
  if (recorded.size() == now.size() || (cut && recorded.size() < now.size())) return std::nullopt;
  return fmt::format("{} packets recorded, {} now", recorded.size(), now.size());
}

struct Compared {
  std::size_t steps = 0, packets = 0, bytes = 0;

  void add(const std::vector<pil::Packet>& recorded) {
    ++steps;
    packets += recorded.size();
    for (const pil::Packet& packet : recorded) bytes += packet.size();
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{} steps, {} packets, {} bytes of output", steps, packets, bytes);
  }
};

/// Removes the packets in which a restart is reported.
std::vector<pil::Packet> without_health(std::vector<pil::Packet> packets) {
  std::erase_if(packets, [](const pil::Packet& bytes) {
    const auto packet = fsw::packets::parse_packet(bytes);
    using fsw::packets::Apid;
    return packet.ok() && (packet.value().header.apid == Apid::kTelemetryHealth ||
                           packet.value().header.apid == Apid::kTelemetryEvent);
  });
  return packets;
}

/// The first steps, of which a snapshot takes the place, if there is one.
struct Continuation {
  std::optional<Snapshot> snapshot;

  [[nodiscard]] bool is_skipped(std::uint32_t step) const { return snapshot && step < snapshot->next_step; }
  [[nodiscard]] std::vector<pil::Packet> compared(std::vector<pil::Packet> packets) const {
    return snapshot ? without_health(std::move(packets)) : packets;
  }
};

Continuation continuation(const ReplayOptions& options, const RecordedSteps& steps, pil::FlightComputer& computer) {
  if (options.from.empty()) return {};
  Continuation from{read_snapshot(options.from)};
  if (!steps.contains(from.snapshot->next_step))
    throw Refused(fmt::format("{}: continues at step {}, which the run does not have", options.from.string(),
                              from.snapshot->next_step));
  try {
    computer.restore(from.snapshot->bytes);
  } catch (const pil::FlightComputerError& error) {
    throw Refused(fmt::format("{}: {}", options.from.string(), error.what()));
  }
  return from;
}

void save_snapshot(const ReplayOptions& options, std::uint32_t next_step, pil::FlightComputer& computer) {
  std::vector<std::uint8_t> bytes = computer.snapshot();
  if (bytes.empty())
    throw Refused("--save: " + computer.description() +
                  " gives no snapshot; accepted: vbar's flight software, --at-h after the first step");
  write_snapshot(options.save, {next_step, std::move(bytes)});
}

/// Feeds the steps to the flight computer and compares its answers. `may_be_cut`: the last step may not be whole.
Verdict compare(const ReplayOptions& options, fsw::GpsTime save_until, const RecordedSteps& steps, bool may_be_cut,
                twins::TileSource& tiles, pil::FlightComputer& flight_computer) {
  const Continuation from = continuation(options, steps, flight_computer);
  Compared compared;
  bool must_save = !options.save.empty();
  for (const auto& [number, step] : steps) {
    if (from.is_skipped(number)) continue;
    if (must_save && step.inputs.front().time > save_until) {
      save_snapshot(options, number, flight_computer);
      must_save = false;
    }
    if (stop_requested()) return {kInterrupted, "interrupted after " + compared.text()};
    const bool cut = may_be_cut && number == steps.rbegin()->first;
    if (cut && step.outputs.empty()) continue;  // the log ends before the answer
    const pil::StepResult answer = flight_computer.step(number, packets_of(step.inputs, tiles));
    if (const auto what = difference(from.compared(step.outputs), from.compared(answer.packets), cut))
      return {kDifferent, fmt::format("differs at step {}: {}; identical before: {}", number, *what, compared.text())};
    compared.add(step.outputs);
  }
  if (must_save) save_snapshot(options, steps.rbegin()->first + 1, flight_computer);
  flight_computer.close();
  std::string sentence = fmt::format("identical: {} on {}", compared.text(), flight_computer.description());
  if (from.snapshot)
    sentence +=
        fmt::format(" from step {} on, but for health and events, which report the restart", from.snapshot->next_step);
  return {kDone, std::move(sentence)};
}

/// The verdict on a log that passed, fed to the flight computer.
Verdict fly_again(const ReplayOptions& options, const mission::Mission& mission, const report::Summary& summary,
                  twins::ImagesOfLog&& images, const RecordedSteps& steps) {
  const auto tiles =
      sensors::make_tile_source({mission, flying_spacecraft(mission), mission::data_directory()}, std::move(images));
  const auto flight_computer = connect_flight_computer(flying_spacecraft(mission));
  const fsw::GpsTime save_until = mission.epoch + fsw::nearest_duration(3600.0 * options.save_at_h);
  Verdict verdict = compare(options, save_until, steps, !has_ended(summary), *tiles, *flight_computer);
  if (verdict.code != kDone) return verdict;
  if (has_ended(summary) && options.from.empty()) {
    verdict.sentence += fmt::format("; all steps of the run, SHA-256 as in its summary (commands {}, telemetry {})",
                                    summary.commands_sha256.substr(0, 16), summary.telemetry_sha256.substr(0, 16));
    if (!summary.complete)
      verdict.sentence += fmt::format("; the run itself is incomplete: {}", summary.incomplete_reason);
    return verdict;
  }
  if (has_ended(summary)) return verdict;
  return {kKilledRun, "the run was killed and left no summary to compare with; what it left is " + verdict.sentence};
}

int say(const Verdict& verdict, bool quiet) {
  if (!quiet || verdict.code != kDone) fmt::print("{}\n", verdict.sentence);
  return verdict.code;
}

}  // namespace

int replay_command(const ReplayOptions& options) {
  const report::Summary summary = summary_of_run(options.run_folder);
  const mission::Mission mission = mission_as_flown(options);
  const std::filesystem::path file = report::packet_log_file(options.run_folder);
  twins::PacketLog log;
  try {
    log = twins::read_packet_log(file);
  } catch (const twins::DamagedLog& error) {
    return say({kDamagedLog, error.what()}, options.quiet);
  }
  const RecordedSteps steps = steps_of(log);
  if (const auto verdict = verdict_on_log(file, log, steps, summary)) return say(*verdict, options.quiet);
  catch_stop_signals();
  if (!options.quiet) {
    for (const std::string& change : changes_since(summary.provenance, options.run_folder / kMissionCopy,
                                                   flight_software_file(flying_spacecraft(mission))))
      fmt::print("note: {}\n", change);
  }
  try {
    return say(fly_again(options, mission, summary, std::move(log), steps), options.quiet);
  } catch (const twins::DamagedLog& error) {
    return say({kDamagedLog, error.what()}, options.quiet);
  }
}

}  // namespace vbar::app
