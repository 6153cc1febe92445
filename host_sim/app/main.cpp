// vbar: flies missions, replays their packets, reports on runs.

#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "host_sim/app/commands.h"

namespace {

constexpr const char* kSetHelp =
    "a key of the mission file and its value, e.g. flight_computer.target=zynq_qemu; may be given again";

}  // namespace

int main(int argc, char** argv) {
  using namespace vbar::app;
  CLI::App program{"Flight-software harness for spacecraft rendezvous and formation flying"};
  program.require_subcommand(1);
  int exit_code = 0;

  RunOptions run;
  std::uint64_t seed = 0;
  CLI::App* run_app = program.add_subcommand("run", "fly a mission and leave a run folder");
  run_app->add_option("mission", run.mission, "mission file (TOML)")->required();
  const CLI::Option* seed_option = run_app->add_option("--seed", seed, "seed of every random stream (mission.seed)");
  run_app->add_option("--out", run.out, "run folder; runs/<mission>-<seed> unless given");
  run_app->add_option("--set", run.overrides, kSetHelp);
  run_app->callback([&] {
    if (*seed_option) run.overrides.push_back("mission.seed=" + std::to_string(seed));
    exit_code = run_command(run);
  });

  PropagateOptions propagate;
  CLI::App* propagate_app = program.add_subcommand(
      "propagate", "fly a mission's spacecraft without flight software and leave their ephemerides");
  propagate_app->add_option("mission", propagate.mission, "mission file (TOML)")->required();
  propagate_app->add_option("--out", propagate.out, "folder; runs/<mission>-truth unless given");
  propagate_app->add_flag("--oem", propagate.oem, "write CCSDS orbit ephemeris messages as well");
  propagate_app->add_option("--set", propagate.overrides, kSetHelp);
  propagate_app->callback([&] { exit_code = propagate_command(propagate); });

  ReplayOptions replay;
  CLI::App* replay_app =
      program.add_subcommand("replay", "feed a run's packets to a flight computer; are the outputs the same bits?");
  replay_app->add_option("run", replay.run_folder, "run folder")->required();
  replay_app->add_option("--set", replay.overrides, kSetHelp);
  replay_app->callback([&] { exit_code = replay_command(replay); });

  std::vector<std::filesystem::path> folders;
  CLI::App* report_app = program.add_subcommand("report", "write the report of a run, or of several side by side");
  report_app->add_option("run", folders, "run folders")->required();
  std::filesystem::path report_out;
  report_app->add_option("--out", report_out,
                         "file of the comparison; comparison.html beside the first run unless given");
  report_app->callback([&] { exit_code = report_command(folders, report_out); });

  std::filesystem::path missions = "missions";
  CLI::App* missions_app = program.add_subcommand("missions", "what can be run, one line each");
  missions_app->add_option("folder", missions, "folder of mission files");
  missions_app->callback([&] { exit_code = missions_command(missions); });

  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vbar: {}\n", error.what());
    return 1;
  }
  return exit_code;
}
