// vbar run: a mission file, a flight computer, a run folder.

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/packet_keepers.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/simulation.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/extends.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"
#include "host_sim/report/waypoint_table.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {
namespace {

report::Summary start_of(const mission::Mission& mission) {
  report::Summary summary;
  summary.mission = mission.name;
  summary.seed = mission.seed;
  return summary;
}

/// The mission file as it was flown, for the replay.
void keep_mission(const mission::Mission& mission, const RunOptions& options, const std::filesystem::path& folder) {
  report::replace_text_file(folder / kMissionCopy, mission::whole_mission_text(mission.file));
  std::ofstream overrides(folder / kOverridesCopy);
  for (const std::string& line : options.overrides) overrides << line << '\n';
  if (!overrides) throw std::runtime_error((folder / kOverridesCopy).string() + ": cannot be written");
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
std::optional<std::string> fly(const mission::Mission& mission, const std::filesystem::path& folder,
                               report::RunRecord& record) {
  PacketKeepers keepers(mission, folder);
  const std::unique_ptr<pil::FlightComputer> flight_computer = connect_flight_computer(flying_spacecraft(mission));
  const auto wall = mission::make_wall_clock(mission, sensors::installation());
  ProgressLine progress(mission.duration);
  const Simulation::Surroundings surroundings{*flight_computer, *wall, keepers.observers(),
                                              [&](fsw::Duration simulated) { progress.update(simulated); },
                                              stop_requested};
  Simulation simulation(mission, mission::data_directory(), surroundings, record);
  std::optional<std::string> trouble;
  try {
    if (!simulation.run()) trouble = "interrupted";
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  summarise_flight_steps(record, simulation.cost_unit());
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  if (!trouble) flight_computer->close();
  return trouble;
}

}  // namespace

int run_command(const RunOptions& options) {
  const mission::Mission mission = sensors::load_mission(options.mission, options.overrides);
  static_cast<void>(flying_spacecraft(mission));  // refused before there is a folder
  const std::filesystem::path out =
      options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out;
  const report::RunFolder folder(out, start_of(mission));
  keep_mission(mission, options, folder.path());
  catch_stop_signals();

  report::RunRecord record;
  std::optional<std::string> trouble;
  try {
    trouble = fly(mission, folder.path(), record);
  } catch (const std::exception& error) {
    trouble = error.what();  // not even begun
  }
  record.summary.mission = mission.name;
  record.summary.seed = mission.seed;
  record.summary.complete = !trouble;
  record.summary.incomplete_reason = trouble.value_or("");
  folder.finish(record);

  if (!record.waypoints.empty()) fmt::print("{}", report::waypoint_table(record));
  fmt::print("report  {}\n", report::write_html_report(folder.path(), record).string());
  if (!trouble) return 0;
  fmt::print(stderr, "vbar: {}: run incomplete: {}\n", folder.path().string(), *trouble);
  return 1;
}

}  // namespace vbar::app
