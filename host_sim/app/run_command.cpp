// vbar run: a mission file, a flight computer, a run folder.

#include <memory>
#include <optional>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/limit_verdict.h"
#include "host_sim/app/recorded_flight.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/extends.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {

using report::RunFolder;

int run_command(const RunOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  const FlightOrder order{mission, mission::whole_mission_text(mission.file),
                          mission::with_absolute_files(options.overrides, mission), options.quiet};
  catch_stop_signals();
  const std::unique_ptr<AssembledMission> assembled = assemble(mission, !options.check);
  if (options.check) {
    if (!options.quiet) {
      report_data(assembled->data_notes());
      fmt::print("{}: can be flown\n", options.mission.string());
    }
    return kDone;
  }
  report::RunRecord record = record_at_start(order);
  RunFolder folder(options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out,
                   record.summary, options.force ? RunFolder::Existing::kReplace : RunFolder::Existing::kRefuse,
                   sensors::extensions());
  const std::optional<std::string> trouble = fly_into(folder, order, *assembled, record);
  report_flight(folder.path(), folder.path(), order, record, trouble);
  if (!options.quiet) print_own_limits(folder.path());
  return exit_code_of(record, trouble, folder.path(), options.quiet);
}

}  // namespace vbar::app
