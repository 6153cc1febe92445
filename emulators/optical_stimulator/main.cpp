// vbar_os_bench: the display, lenses, rails and camera of an Optical Stimulator, emulated behind their wire protocols.

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <fmt/format.h>

#include "emulators/common/emulator_program.h"
#include "emulators/optical_stimulator/emulator.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/mission_error.h"

namespace {

namespace bench = vbar::optical_stimulator::bench;

enum ExitCode { kDone = 0, kFailed = 1, kRefused = 2, kFaultExit = 3 };

int run(const bench::BenchSettings& settings, const std::filesystem::path& directory) {
  boost::asio::io_context context(1);
  boost::asio::signal_set signals(context, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&](const boost::system::error_code&, int) { context.stop(); });
  std::signal(SIGPIPE, SIG_IGN);
  const vbar::emulators::ParentWatch watch(context);
  const bench::Bench emulator(context, settings, vbar::mission::data_directory(), directory,
                              [] { std::_Exit(kFaultExit); });
  context.run();
  return kDone;
}

int complain(const char* what, int exit_code) {
  fmt::print(stderr, "vbar_os_bench: {}\n", what);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Emulated Optical Stimulator: display, lenses, rails and camera behind their wire protocols"};
  std::filesystem::path bench_file, directory;
  std::vector<std::string> assignments;
  std::string pace;
  std::uint64_t seed = 0;
  program.add_option("bench", bench_file, "bench file (TOML)")->required();
  program.add_option("--directory", directory, "where the serial line, sockets and addresses.json are made")
      ->required();
  const CLI::Option* seed_option = program.add_option("--seed", seed, "seed of every draw");
  program.add_option("--set", assignments, "a key of the bench file and its value; may be given again")
      ->allow_extra_args(false);
  const CLI::Option* pace_option = program.add_option("--pace", pace, "fast or real");
  CLI11_PARSE(program, argc, argv);
  if (*seed_option) assignments.push_back("seed=" + std::to_string(seed));
  if (*pace_option) assignments.push_back("pace=" + pace);
  try {
    return run(bench::read_bench(bench_file, assignments), directory);
  } catch (const vbar::mission::MissionError& error) {
    return complain(error.what(), kRefused);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailed);
  }
}
