// vbar run: a mission file, a flight computer, a run folder.

#include <chrono>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "host_sim/app/assemble.h"
#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_from.h"
#include "host_sim/app/packet_keepers.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/extends.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/summarise.h"
#include "host_sim/report/text_file.h"
#include "host_sim/report/waypoint_table.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {
namespace {

using report::RunFolder;

constexpr const char* kInterruption = "interrupted";

/// What is known before the first step.
report::Summary start_of(const mission::Mission& mission) {
  report::Summary summary;
  summary.mission = mission.name;
  summary.seed = mission.seed;
  summary.target = flying_spacecraft(mission).observes();
  for (const double hour : mission.record.samples_h) summary.samples.push_back({.time_h = hour});
  return summary;
}

/// The mission file as it was flown, for the replay.
void keep_mission(const std::string& text, const RunOptions& options, const std::filesystem::path& folder) {
  report::replace_text_file(folder / kMissionCopy, text);
  report::replace_text_file(folder / kOverridesCopy, fmt::format("{}\n", fmt::join(options.overrides, "\n")));
}

/// Flies and fills the record. The reason why the run is not complete, or nothing.
std::optional<std::string> fly(const mission::Mission& mission, AssembledMission& assembled, RunFolder& folder,
                               bool quiet, report::RunRecord& record) {
  constexpr std::chrono::seconds kBetweenUpdates{1};
  PacketKeepers keepers(mission, folder.path());
  const std::unique_ptr<pil::FlightComputer> flight_computer =
      connect_flight_computer(flying_spacecraft(mission), assembled.wired_receiver());
  const auto wall = mission::make_wall_clock(mission, sensors::installation());
  ProgressLine progress(mission.duration, quiet);
  auto updated = std::chrono::steady_clock::now();
  const auto after_step = [&](fsw::Duration simulated) {
    progress.update(simulated);
    if (std::chrono::steady_clock::now() - updated < kBetweenUpdates) return;
    folder.update(record);
    updated = std::chrono::steady_clock::now();
  };
  std::optional<std::string> trouble;
  try {
    const bool complete = assembled.fly(
        {*flight_computer, *wall, keepers.observers(), after_step, stop_requested, folder.path()}, record);
    if (!complete) trouble = kInterruption;
    keepers.finish();
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  if (!trouble) flight_computer->close();
  return trouble;
}

/// Flies, and leaves the record in the folder: whole, or with the reason why it is not. That reason, or nothing.
std::optional<std::string> fly_into(RunFolder& folder, const mission::Mission& mission, AssembledMission& assembled,
                                    bool quiet, report::RunRecord& record) {
  std::optional<std::string> trouble;
  try {
    trouble = fly(mission, assembled, folder, quiet, record);
  } catch (const std::exception& error) {
    trouble = error.what();  // before the first step
  }
  record.summary.complete = !trouble;
  record.summary.incomplete_reason = trouble.value_or("");
  record.summary.provenance.data = data_read();
  record.summary.provenance.packet_log = report::digest_of(folder.packet_log());
  if (auto& log = record.summary.provenance.packet_log) log->file = folder.packet_log().filename().string();
  try {
    folder.finish(record);
    return trouble;
  } catch (const std::exception& error) {
    const std::string reason = trouble ? *trouble + "; " + error.what() : error.what();
    folder.give_up(record.summary, reason);
    return reason;
  }
}

/// The mission with its sources started: whatever cannot fly is refused before there is a run folder.
std::unique_ptr<AssembledMission> assemble(const mission::Mission& mission, bool start) {
  try {
    auto assembled = std::make_unique<AssembledMission>(mission, mission::data_directory());
    if (start) assembled->start();
    return assembled;
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
}

/// Dropped packets and refused plans are always reported.
void report_health(const report::Summary& summary) {
  const std::string line = summary.health ? report::health_line(*summary.health) : "";
  if (!line.empty()) fmt::print("flight software: {}\n", line);
}

void report_data(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print("data: {}\n", note);
}

}  // namespace

int run_command(const RunOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  const std::string mission_text = mission::whole_mission_text(mission.file);
  catch_stop_signals();
  const std::unique_ptr<AssembledMission> assembled = assemble(mission, !options.check);
  if (options.check) {
    if (!options.quiet) fmt::print("{}: can be flown\n", options.mission.string());
    return kDone;
  }
  report::RunRecord record;
  record.extensions = sensors::extensions();
  record.summary = start_of(mission);
  record.summary.data_notes = assembled->data_notes();
  if (!options.quiet) report_data(record.summary.data_notes);
  record.summary.provenance = provenance_of(mission, options.overrides, mission_text);
  RunFolder folder(options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out,
                   record.summary, options.force ? RunFolder::Existing::kReplace : RunFolder::Existing::kRefuse,
                   sensors::extensions());
  if (!mission.record.tables) folder.leave_out_tables();
  keep_mission(mission_text, options, folder.path());

  const std::optional<std::string> trouble = fly_into(folder, mission, *assembled, options.quiet, record);
  try {
    if (!options.quiet && !record.waypoints.empty()) fmt::print("{}", report::waypoint_table(record));
    report_health(record.summary);
    if (mission.record.tables) {
      const std::filesystem::path report = report::write_html_report(folder.path(), record);
      if (!options.quiet) fmt::print("report  {}\n", report.string());
    }
  } catch (const std::exception&) {
    if (!trouble) throw;  // the record is complete, its report is not
  }
  for (const report::FaultRow& fault : record.faults) {
    if (!fault.begin_s) {
      fmt::print("fault \"{}\" never began: {} did not happen\n", fault.name, fault.event);
    } else if (!fault.effect_s) {
      fmt::print("fault \"{}\" never took effect\n", fault.name);
    }
  }
  if (!trouble && record.summary.never_navigated) {
    fmt::print(stderr, "vbar: {}: never navigated: no estimate was valid\n", folder.path().string());
    return kNeverNavigated;
  }
  if (!trouble) return kDone;
  fmt::print(stderr, "vbar: {}: run incomplete: {}\n", folder.path().string(), *trouble);
  return *trouble == kInterruption ? kInterrupted : kFailed;
}

}  // namespace vbar::app
