// vbar_grand_bench: an RF generator and GNSS receivers, emulated behind their wire protocols.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>

#include "emulators/common/emulator_program.h"
#include "emulators/grand/generator/emulator.h"
#include "emulators/grand/generator/receiver_ends.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/mission_error.h"

namespace {

namespace asio = boost::asio;
namespace bench = vbar::grand::bench;

enum ExitCode { kDone = 0, kFailed = 1, kRefused = 2, kFaultExit = 3 };

enum class ReceiverKind { kOem628, kGnssSdr };

bench::ReceiverFactory receivers(ReceiverKind kind, const bench::Scenario& scenario,
                                 const std::filesystem::path& directory) {
  return kind == ReceiverKind::kGnssSdr ? bench::gnss_sdr_receivers(scenario, std::filesystem::absolute(directory))
                                        : bench::oem628_receivers(scenario);
}

int run(const bench::Scenario& scenario, const std::filesystem::path& directory, ReceiverKind receiver) {
  asio::io_context context(1);
  asio::signal_set signals(context, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&](const boost::system::error_code&, int) { context.stop(); });
  std::signal(SIGPIPE, SIG_IGN);
  const vbar::emulators::ParentWatch watch(context);
  bench::Bench emulator(context, scenario, vbar::mission::data_directory(), directory,
                        receivers(receiver, scenario, directory));
  emulator.faults().on_exit = [] { std::_Exit(kFaultExit); };
  context.run();
  return kDone;
}

int complain(const char* what, int exit_code) {
  fmt::print(stderr, "vbar_grand_bench: {}\n", what);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Emulated GNSS testbed: RF generator and receivers behind their wire protocols"};
  std::filesystem::path scenario_file;
  std::filesystem::path directory;
  std::vector<std::string> assignments;
  std::string pace;
  std::uint64_t seed = 0;
  ReceiverKind receiver = ReceiverKind::kOem628;
  program.add_option("scenario", scenario_file, "scenario file (TOML)")->required();
  program.add_option("--directory", directory, "where the serial lines, sockets and addresses.json are made")
      ->required();
  const CLI::Option* seed_option = program.add_option("--seed", seed, "seed of every random stream");
  program.add_option("--set", assignments, "a key of the scenario file and its value; may be given again")
      ->allow_extra_args(false);
  const CLI::Option* pace_option = program.add_option("--pace", pace, "lock_step or real_time");
  const std::map<std::string, ReceiverKind> kReceivers{{"oem628", ReceiverKind::kOem628},
                                                       {"gnss_sdr", ReceiverKind::kGnssSdr}};
  program.add_option("--receiver", receiver, "oem628 (emulated) or gnss_sdr (the program gnss-sdr; real time only)")
      ->transform(CLI::CheckedTransformer(kReceivers));
  CLI11_PARSE(program, argc, argv);
  if (*seed_option) assignments.push_back("seed=" + std::to_string(seed));
  if (*pace_option) assignments.push_back("pace=" + pace);
  try {
    return run(bench::read_scenario(scenario_file, assignments), directory, receiver);
  } catch (const vbar::mission::MissionError& error) {
    return complain(error.what(), kRefused);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailed);
  }
}
