// vbar_tron_bench: robots, motion capture, lights and camera of TRON, emulated behind their wire protocols.

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
#include "emulators/tron/emulator.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/mission/mission_error.h"

namespace {

namespace bench = vbar::tron::bench;

enum ExitCode { kDone = 0, kFailed = 1, kRefused = 2, kFaultExit = 3 };

int run(const bench::BenchSettings& settings, const bench::MeasuredPosture& place) {
  boost::asio::io_context context(1);
  boost::asio::signal_set signals(context, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&](const boost::system::error_code&, int) { context.stop(); });
  std::signal(SIGPIPE, SIG_IGN);
  const vbar::emulators::ParentWatch watch(context);
  const bench::Bench emulator(context, settings, place, [] { std::_Exit(kFaultExit); });
  context.run();
  return kDone;
}

int complain(const char* what, int exit_code) {
  fmt::print(stderr, "vbar_tron_bench: {}\n", what);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Emulated TRON: robots, motion capture, lights and camera behind their wire protocols"};
  std::filesystem::path bench_file, fault_file;
  bench::MeasuredPosture place;
  std::vector<std::string> assignments;
  std::string clock;
  std::uint64_t seed = 0;
  program.add_option("bench", bench_file, "bench file (TOML)")->required();
  program.add_option("--directory", place.directory, "where sockets, addresses.json and logs are made")->required();
  const CLI::Option* seed_option = program.add_option("--seed", seed, "seed of every draw");
  const CLI::Option* clock_option = program.add_option("--clock", clock, "virtual or real");
  program.add_option("--set", assignments, "a key of the bench file and its value; may be given again")
      ->allow_extra_args(false);
  program.add_option("--faults", fault_file, "faults, one JSON object a line");
  program.add_option("--truth", place.truth, "file for what was really there at each image; default: DIR/truth.csv");
  program.add_option("--camera-rsi-port", place.ports.camera_rsi, "UDP port of the driver; 0: of the laboratory file");
  program.add_option("--target-rsi-port", place.ports.target_rsi, "UDP port of the driver; 0: of the laboratory file");
  program.add_option("--vicon-port", place.ports.vicon, "UDP port of the driver; 0: of the laboratory file");
  CLI11_PARSE(program, argc, argv);
  if (*seed_option) assignments.push_back("seed=" + std::to_string(seed));
  if (*clock_option) assignments.push_back("clock.kind=" + clock);
  try {
    place.data = vbar::mission::data_directory();
    bench::BenchSettings settings = bench::read_bench(bench_file, assignments);
    if (!fault_file.empty())
      for (const bench::Fault& fault : bench::read_fault_file(fault_file)) settings.faults.push_back(fault);
    return run(settings, place);
  } catch (const vbar::mission::MissionError& error) {
    return complain(error.what(), kRefused);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailed);
  }
}
