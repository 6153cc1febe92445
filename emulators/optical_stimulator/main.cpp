// vbar_os_bench: the display, lenses, rails and camera of an Optical Stimulator, emulated behind their wire protocols.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>

#include "emulators/common/emulator_program.h"
#include "emulators/optical_stimulator/emulator.h"
#include "host_sim/mission/data_file.h"

namespace bench = vbar::optical_stimulator::bench;

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
  return vbar::emulators::run_emulator("vbar_os_bench", [&](boost::asio::io_context& context) {
    return std::make_shared<bench::Bench>(context, bench::read_bench(bench_file, assignments),
                                          vbar::mission::data_directory(), directory, vbar::emulators::exit_by_fault);
  });
}
