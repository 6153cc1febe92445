// vbar run: a mission file, a flight computer, a run folder.

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/data_directory.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_from.h"
#include "host_sim/app/packet_keepers.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/simulation.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/extends.h"
#include "host_sim/mission/load.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"
#include "host_sim/report/waypoint_table.h"

namespace vbar::app {
namespace {

constexpr const char* kInterruption = "interrupted";

report::Summary start_of(const mission::Mission& mission) {
  report::Summary summary;
  summary.mission = mission.name;
  summary.seed = mission.seed;
  return summary;
}

/// The mission file as it was flown, for the replay.
void keep_mission(const std::string& text, const RunOptions& options, const std::filesystem::path& folder) {
  report::replace_text_file(folder / kMissionCopy, text);
  report::replace_text_file(folder / kOverridesCopy, fmt::format("{}\n", fmt::join(options.overrides, "\n")));
}

/// What the flight computer's steps cost.
void summarise_flight_steps(report::RunRecord& record, const std::string& unit) {
  report::Summary::FlightStep& total = record.summary.flight_step;
  total.unit = unit;
  double sum = 0.0;
  for (const report::EstimateRow& row : record.estimates) {
    ++total.count;
    total.max = std::max(total.max, row.step_cost);
    total.stack_bytes_max = std::max(total.stack_bytes_max, row.stack_bytes);
    sum += static_cast<double>(row.step_cost);
  }
  if (total.count > 0) total.mean = sum / static_cast<double>(total.count);
}

/// Flies and fills the record. The reason why the run is not complete, or nothing.
std::optional<std::string> fly(const mission::Mission& mission, const std::filesystem::path& folder, bool quiet,
                               report::RunRecord& record) {
  PacketKeepers keepers(mission, folder);
  const std::unique_ptr<pil::FlightComputer> flight_computer = connect_flight_computer(flying_spacecraft(mission));
  engine::SteadyWallClock wall;
  ProgressLine progress(mission.duration, quiet);
  const Simulation::Surroundings surroundings{*flight_computer, wall, keepers.observers(),
                                              [&](fsw::Duration simulated) { progress.update(simulated); },
                                              stop_requested};
  Simulation simulation(mission, data_directory(), surroundings, record);
  std::optional<std::string> trouble;
  try {
    if (!simulation.run()) trouble = kInterruption;
    keepers.finish();
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  summarise_flight_steps(record, simulation.cost_unit());
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  if (!trouble) flight_computer->close();
  return trouble;
}

/// Flies, and leaves the record in the folder: whole, or with the reason why it is not. That reason, or nothing.
std::optional<std::string> fly_into(const report::RunFolder& folder, const mission::Mission& mission, bool quiet,
                                    report::RunRecord& record) {
  std::optional<std::string> trouble;
  try {
    trouble = fly(mission, folder.path(), quiet, record);
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

}  // namespace

int run_command(const RunOptions& options) {
  using report::RunFolder;
  const mission::Mission mission = mission::load_mission(mission::find_mission(options.mission), options.overrides);
  report::RunRecord record;
  record.summary = start_of(mission);
  const std::string mission_text = mission::whole_mission_text(mission.file);
  try {
    static_cast<void>(flying_spacecraft(mission));
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
  if (options.check) {
    if (!options.quiet) fmt::print("{}: can be flown\n", options.mission.string());
    return kDone;
  }
  record.summary.provenance = provenance_of(mission, options.overrides, mission_text);
  const RunFolder folder(options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out,
                         record.summary, options.force ? RunFolder::Existing::kReplace : RunFolder::Existing::kRefuse);
  catch_stop_signals();
  keep_mission(mission_text, options, folder.path());

  const std::optional<std::string> trouble = fly_into(folder, mission, options.quiet, record);
  try {
    const std::filesystem::path report = report::write_html_report(folder.path(), record);
    if (!options.quiet && !record.waypoints.empty()) fmt::print("{}", report::waypoint_table(record));
    if (!options.quiet) fmt::print("report  {}\n", report.string());
  } catch (const std::exception&) {
    if (!trouble) throw;  // the record is complete, its report is not
  }
  if (!trouble) return kDone;
  fmt::print(stderr, "vbar: {}: run incomplete: {}\n", folder.path().string(), *trouble);
  return *trouble == kInterruption ? kInterrupted : kFailed;
}

}  // namespace vbar::app
