// vbar run: a mission file, a flight computer, a run folder.

#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <spawn.h>
#include <unistd.h>

#include "host_sim/cli/commands.h"
#include "host_sim/cli/recorded_flight.h"
#include "host_sim/cli/verdicts.h"
#include "host_sim/files/error_lines.h"
#include "host_sim/files/own_program.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_directory.h"
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

/// Starts the program that serves the page of a run: a process of its own, which reads the folder as it grows, so that
/// no viewer can delay or change the run. It inherits no descriptor but the standard ones: the lock of the folder ends
/// with the run.
void start_viewer(const std::filesystem::path& program, const std::filesystem::path& run_folder) {
  std::vector<std::string> words{program.string(), run_folder.string(), "--of-run", std::to_string(::getpid())};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  pid_t ignored = 0;
  const int error = ::posix_spawn(&ignored, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    files::print_error(
        "vbar", fmt::format("{} cannot be started: {}", program.string(), std::generic_category().message(error)));
}

std::filesystem::path viewer_program() {
  std::filesystem::path program = files::program_beside("watch");
  if (program.empty()) throw Refused("--view: the program vbar_watch is not beside this one");
  return program;
}

}  // namespace

int run_command(const RunOptions& options) {
  const std::filesystem::path viewer = options.view ? viewer_program() : std::filesystem::path();
  const mission::Mission mission =
      sensors::load_mission(mission::find_mission(options.mission, sensors::installation()), options.overrides);
  const FlightOrder order{mission, mission::whole_mission_text(mission.file),
                          mission::with_absolute_files(options.overrides, mission), options.quiet};
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
  if (!viewer.empty()) start_viewer(viewer, folder.path());
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
