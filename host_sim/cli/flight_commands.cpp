// vbar run: a mission file, a flight computer, a run folder.

#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "host_sim/cli/commands.h"
#include "host_sim/cli/recorded_flight.h"
#include "host_sim/cli/verdicts.h"
#include "host_sim/cli/viewer.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/report/propagation_folder.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/simulation/run_truth.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {

using report::RunFolder;

namespace {

/// The pace of a run is changed through its clock, which paces nothing in lock-step; hardware does not pause.
void check_control(const mission::Mission& mission) {
  if (mission.clock.mode != engine::ClockMode::kRealTime)
    throw Refused(
        "--view-control: clock.mode: found \"lock_step\"; accepted: \"real_time\", as by "
        "--set clock.mode=real_time --set clock.speed_factor=100");
  if (!mission.testbeds.empty())
    throw Refused(
        fmt::format("--view-control: found testbed.{}; accepted: a mission without a testbed, whose "
                    "hardware would not pause",
                    mission.testbeds.front().name));
}

}  // namespace

int run_command(const RunOptions& options) {
  const bool is_viewed = options.view || options.view_control;
  const std::filesystem::path viewer_program = is_viewed ? Viewer::program() : std::filesystem::path();
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  std::optional<Viewer> viewer;
  FlightOrder order{mission, mission::whole_mission_text(mission.file),
                    mission::with_absolute_files(options.overrides, mission), options.quiet};
  if (options.view_control) {
    check_control(mission);
    order.pace_requests = [&viewer] { return viewer->next_request(); };
  }
  catch_stop_signals();
  const std::unique_ptr<AssembledMission> assembled = assemble(mission, !options.check);
  if (options.check) {
    if (!options.quiet) {
      report_before_flight(*assembled);
      fmt::print("{}: can be flown\n", options.mission.string());
    }
    return kDone;
  }
  report::RunRecord record = record_at_start(order);
  RunFolder folder(options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out,
                   record.summary, options.force ? RunFolder::Existing::kReplace : RunFolder::Existing::kRefuse,
                   sensors::extensions());
  if (is_viewed)
    viewer.emplace(viewer_program, folder.path(),
                   options.view_control ? std::optional(mission.clock.speed_factor) : std::nullopt);
  const std::optional<std::string> trouble = fly_into(folder, order, *assembled, record);
  report_flight(folder.path(), folder.path(), order, record, trouble);
  if (!options.quiet) print_own_limits(folder.path());
  return exit_code_of(record, trouble, folder.path(), options.quiet);
}

// vbar propagate: a mission file, its truth alone, an ephemeris of every spacecraft.

namespace {

/// Returns the time of this computer's clock, to a second.
fsw::GpsTime now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return truth::gps_from_utc(fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", utc));
}

}  // namespace

int propagate_command(const PropagateOptions& options) {
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  if (mission.truth_source != mission::kTruthModel)
    throw Refused(fmt::format("truth.source: found \"{}\"; accepted: model, which is what vbar propagate propagates",
                              mission.truth_source));
  Propagation propagation = [&] {
    try {
      return Propagation(mission, mission::data_directory());
    } catch (const std::exception& error) {
      throw Refused(error.what());  // nothing is written yet
    }
  }();
  report::PropagationFolder folder(options.out.empty() ? report::default_propagation_folder(mission.name) : options.out,
                                   mission.name);
  const report::OemFile::Span span{mission.start_time(), mission.end_time(), propagation.sampling_times().size(),
                                   now()};
  folder.start_files(propagation.names(), options.oem ? &span : nullptr);
  catch_stop_signals();

  report::PropagationRecord record;
  {
    ProgressLine progress(mission.duration, options.quiet);
    record = propagation.run([&](std::size_t k, const report::EphemerisRow& row) { folder.append(k, row); },
                             [&](fsw::Duration simulated) { progress.update(simulated); }, stop_requested);
  }
  folder.finish(record);
  if (!options.quiet) fmt::print("{}ephemeris  {}\n", report::propagation_table(record), folder.path().string());
  if (record.complete) return kDone;
  files::print_error("vbar",
                     fmt::format("{}: propagation incomplete: {}", folder.path().string(), record.incomplete_reason));
  return record.incomplete_reason == Propagation::kInterruption ? kInterrupted : kFailed;
}

}  // namespace vbar::app
