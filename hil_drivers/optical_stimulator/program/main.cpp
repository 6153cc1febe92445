// vbar_os_calibrate: calibrates an Optical Stimulator over its wires.

#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "hil_drivers/optical_stimulator/program/wired_testbed.h"
#include "host_sim/files/output_file.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/sensors/settings/camera_file.h"

namespace {

namespace os = vbar::optical_stimulator;
namespace calibrate = os::calibrate;

enum ExitCode { kReached = 0, kFailed = 1, kMissed = 3 };

struct Options {
  std::string bench;  ///< command line of an emulator
  std::uint64_t seed = 1;
  std::string camera, x_display, output, rails;
  std::filesystem::path out, camera_file;
  int settle_ms = 50;
  bool is_quick = false;
  calibrate::ProcedureSettings procedure;
};

void write_page(const std::string& page, const std::filesystem::path& file) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << page;
  stream.flush();
  if (!stream) throw vbar::files::write_error(file);
}

calibrate::WiredBenchSettings wires_of(const Options& options,
                                       const std::optional<vbar::testbeds::EmulatorProcess>& process) {
  os::TestbedAddresses addresses;
  if (process) addresses = os::read_addresses(process->addresses_file());
  calibrate::WiredBenchSettings wires;
  wires.camera_address = options.camera.empty() ? addresses.camera : options.camera;
  wires.rails = options.rails.empty() ? addresses.rails : options.rails;
  wires.display.x_display = options.x_display.empty() ? addresses.display : options.x_display;
  wires.display.output = options.output;
  wires.settle = std::chrono::milliseconds(options.settle_ms);
  wires.width = options.procedure.camera.detector.width;
  wires.height = options.procedure.camera.detector.height;
  wires.bits = options.procedure.camera.detector.bits;
  if (wires.camera_address.empty() || wires.rails.empty())
    throw std::runtime_error("the addresses of camera and rails are missing: --camera and --rails, or --bench");
  return wires;
}

void print_figures(const os::HeldOutResiduals& held_out) {
  const auto row = [](const char* name, const os::ResidualFigures& with, const os::ResidualFigures& lens, double mean,
                      double p95) {
    fmt::print(
        "{:<15} mean {:5.2f} (goal {:.1f}), 95 % {:5.2f} (goal {:.1f}) arcsec; lens terms alone {:5.2f}, {} dots\n",
        name, with.mean_arcsec, mean, with.p95_arcsec, p95, lens.mean_arcsec, with.dots);
  };
  row("region", held_out.region, held_out.region_lens_terms, calibrate::kRegionMeanGoal_arcsec,
      calibrate::kRegionP95Goal_arcsec);
  row("whole detector", held_out.detector, held_out.detector_lens_terms, calibrate::kDetectorMeanGoal_arcsec,
      calibrate::kDetectorP95Goal_arcsec);
}

int run(Options& options) {
  const auto begin = std::chrono::steady_clock::now();
  const std::filesystem::path data = vbar::mission::data_directory();
  if (options.camera_file.empty()) options.camera_file = data / "cameras" / "optical_stimulator.toml";
  options.procedure.camera = vbar::sensors::load_camera(options.camera_file).settings();
  // Before the measurement of a minute, which a folder that cannot be made would lose.
  if (options.out.has_parent_path()) std::filesystem::create_directories(options.out.parent_path());
  std::optional<vbar::testbeds::EmulatorProcess> process;
  if (!options.bench.empty()) process.emplace(options.bench, options.seed, data);
  calibrate::WiredTestbed wired(wires_of(options, process));
  fmt::print("{}\n", wired.transport());
  const auto progress = [&](const std::string& line) {
    fmt::print("{:6.1f} s  {}\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               line);
    std::fflush(stdout);
  };
  calibrate::ProcedureResult result = calibrate::calibrate(wired.bench(), options.procedure, progress);
  os::Validity& validity = result.calibration.validity;
  wired.identify(validity);
  validity.date_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  os::save_calibration(result.calibration, options.out);
  write_page(calibrate::calibration_page(result), std::filesystem::path(options.out).replace_extension(".html"));
  if (validity.emulated) fmt::print("emulated bench\n");
  print_figures(result.calibration.held_out);
  progress(fmt::format("{}: {} frames, {} of them taken again", options.out.string(), wired.frames(),
                       wired.repeated_frames()));
  if (result.calibration.held_out.goal_reached) return kReached;
  fmt::print(stderr, "vbar_os_calibrate: the calibration does not reach its goal\n");
  return kMissed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{
      "Calibrates an Optical Stimulator over its wires. Exit code 3: the residuals of the dots held out miss their "
      "goal"};
  Options options;
  program.add_option("--out", options.out, "calibration file (TOML); the page is written beside it (HTML)")->required();
  program.add_option("--bench", options.bench,
                     "command line that starts an emulated bench; {data}, {directory} and {seed} are replaced");
  program.add_option("--seed", options.seed, "of the emulated bench and of the places of held-out dots");
  program.add_option("--camera", options.camera, "IP address of the camera");
  program.add_option("--x-display", options.x_display, "X display of the microdisplay");
  program.add_option("--output", options.output, "its output");
  program.add_option("--rails", options.rails, "serial line or host:port of the rails");
  program.add_option("--camera-file", options.camera_file, "camera file (TOML)");
  program.add_option("--settle-ms", options.settle_ms, "from a picture on the screen to its light");
  program.add_option("--lens-mm", options.procedure.lens_mm, "place of lens 2 on its axis: the magnification");
  program.add_option("--display-mm", options.procedure.display_mm,
                     "place of the display on its axis where the focus is searched");
  program.add_option("--focus-range-mm", options.procedure.focus_range_mm, "on both sides of it");
  program.add_flag("--quick", options.is_quick, "fewer pictures, for a test of the whole path");
  CLI11_PARSE(program, argc, argv);
  options.procedure.seed = options.seed;
  if (options.is_quick) options.procedure = calibrate::quick(options.procedure);
  std::signal(SIGPIPE, SIG_IGN);  // an X server that goes away is an error with a sentence
  try {
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vbar_os_calibrate: {}\n", error.what());
    return kFailed;
  }
}
