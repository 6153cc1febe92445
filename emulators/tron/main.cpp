// vbar_tron_bench: robots, motion capture, lights and camera of TRON, emulated behind their wire protocols.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>

#include "emulators/common/emulator_program.h"
#include "emulators/tron/emulator.h"
#include "host_sim/mission/data_file.h"

namespace bench = vbar::tron::bench;

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
  return vbar::emulators::run_emulator("vbar_tron_bench", [&](boost::asio::io_context& context) {
    place.data = vbar::mission::data_directory();
    bench::BenchSettings settings = bench::read_bench(bench_file, assignments);
    if (!fault_file.empty())
      for (const bench::Fault& fault : bench::read_fault_file(fault_file)) settings.faults.push_back(fault);
    return std::make_shared<bench::Bench>(context, settings, place, vbar::emulators::exit_by_fault);
  });
}
