// vbar run: a mission file, a flight computer, a run folder.

#include <chrono>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "host_sim/app/assemble.h"
#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/packet_keepers.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/stop_request.h"
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

report::Summary start_of(const mission::Mission& mission) {
  report::Summary summary;
  summary.mission = mission.name;
  summary.seed = mission.seed;
  summary.target = flying_spacecraft(mission).observes();
  return summary;
}

/// The mission file as it was flown, for the replay.
void keep_mission(const mission::Mission& mission, const RunOptions& options, const std::filesystem::path& folder) {
  report::replace_text_file(folder / kMissionCopy, mission::whole_mission_text(mission.file));
  std::ofstream overrides(folder / kOverridesCopy);
  for (const std::string& line : options.overrides) overrides << line << '\n';
  if (!overrides) throw std::runtime_error((folder / kOverridesCopy).string() + ": cannot be written");
}

/// Flies and fills the record. The reason why the run is not complete, or nothing.
std::optional<std::string> fly(const mission::Mission& mission, AssembledMission& assembled, report::RunFolder& folder,
                               report::RunRecord& record) {
  constexpr std::chrono::seconds kBetweenUpdates{1};
  PacketKeepers keepers(mission, folder.path());
  const std::unique_ptr<pil::FlightComputer> flight_computer = connect_flight_computer(flying_spacecraft(mission));
  const auto wall = mission::make_wall_clock(mission, sensors::installation());
  ProgressLine progress(mission.duration);
  auto updated = std::chrono::steady_clock::now();
  const auto after_step = [&](fsw::Duration simulated) {
    progress.update(simulated);
    if (std::chrono::steady_clock::now() - updated < kBetweenUpdates) return;
    folder.update(record);
    updated = std::chrono::steady_clock::now();
  };
  std::optional<std::string> trouble;
  try {
    const bool complete =
        assembled.fly({*flight_computer, *wall, keepers.observers(), after_step, stop_requested}, record);
    if (!complete) trouble = "interrupted";
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  if (!trouble) flight_computer->close();
  return trouble;
}

/// Packets that were dropped, plans that were refused: never without a word.
void report_health(const report::Summary& summary) {
  const std::string line = summary.health ? report::health_line(*summary.health) : "";
  if (!line.empty()) fmt::print("flight software: {}\n", line);
}

}  // namespace

int run_command(const RunOptions& options) {
  const mission::Mission mission = sensors::load_mission(options.mission, options.overrides);
  catch_stop_signals();
  // Whatever cannot fly, and a source that is not ready, is refused before there is a folder.
  AssembledMission assembled(mission, mission::data_directory());
  assembled.start();
  const std::filesystem::path out =
      options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out;
  report::RunFolder folder(out, start_of(mission));
  keep_mission(mission, options, folder.path());

  report::RunRecord record;
  std::optional<std::string> trouble;
  try {
    trouble = fly(mission, assembled, folder, record);
  } catch (const std::exception& error) {
    trouble = error.what();  // not even begun
  }
  record.summary.mission = mission.name;
  record.summary.seed = mission.seed;
  record.summary.complete = !trouble;
  record.summary.incomplete_reason = trouble.value_or("");
  folder.finish(record);

  if (!record.waypoints.empty()) fmt::print("{}", report::waypoint_table(record));
  report_health(record.summary);
  fmt::print("report  {}\n", report::write_html_report(folder.path(), record).string());
  if (!trouble) return 0;
  fmt::print(stderr, "vbar: {}: run incomplete: {}\n", folder.path().string(), *trouble);
  return 1;
}

}  // namespace vbar::app
