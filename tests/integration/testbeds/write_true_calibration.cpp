// The calibration of an emulated bench without measurement errors, from its file, for tests of runs:
// vbar_os_true_calibration BENCH.toml SEED CALIBRATION.toml. The bench must run with rails.zero_error_mm=0.

#include <cstdio>
#include <exception>

#include "tests/support/optical_bench.h"
#include "tests/support/paths.h"

int main(int argc, char** argv) {
  using namespace vbar::optical_stimulator;
  if (argc != 4) {
    std::fprintf(stderr, "vbar_os_true_calibration BENCH.toml SEED CALIBRATION.toml\n");
    return 2;
  }
  try {
    const auto settings = bench::read_bench(argv[1], {"seed=" + std::string(argv[2]), "rails.zero_error_mm=0"});
    const auto camera = bench::camera_of(settings, vbar::tests::source_path("data"));
    save_calibration(true_calibration(settings, camera, {}), argv[3]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
