// vbar_os_calibrate: calibrates an Optical Stimulator over its wires.

#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "hil_drivers/optical_stimulator/hardware/display.h"
#include "hil_drivers/zaber/client.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/settings/camera_file.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

// Testbed under calibration over its wires: X display, GigE Vision camera, Zaber rails.

struct WiredBenchSettings {
  DisplaySettings display;
  std::string camera_address;
  std::string rails;  ///< a tty, or host:port
  int packet_size = 1400;
  std::chrono::milliseconds settle{50};  ///< from a picture on the screen to its light
  std::chrono::milliseconds timeout{10000};
  int retries = 5;                             ///< tries for an image
  int width = 1920, height = 1200, bits = 12;  ///< size and resolution of the camera
};

class WiredTestbed {
 public:
  /// Throws std::runtime_error, one sentence, if a device does not answer.
  explicit WiredTestbed(const WiredBenchSettings& settings);
  ~WiredTestbed();
  WiredTestbed(const WiredTestbed&) = delete;
  WiredTestbed& operator=(const WiredTestbed&) = delete;

  [[nodiscard]] Bench bench();
  /// Fills in the camera and whether the testbed is emulated.
  void identify(Validity& validity) const;
  [[nodiscard]] std::string transport() const;
  [[nodiscard]] int frames() const;
  [[nodiscard]] int repeated_frames() const;  ///< that did not arrive whole

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

constexpr int kLensAxis = 1, kDisplayAxis = 2;

class WiredScreen final : public Screen {
 public:
  WiredScreen(const DisplaySettings& settings, std::chrono::milliseconds settle)
      : settle_(settle), display_(settings) {}

  [[nodiscard]] int width() const override { return display_.width(); }
  [[nodiscard]] int height() const override { return display_.height(); }
  void show(const Picture& counts) override {
    display_.show(counts);
    std::this_thread::sleep_for(settle_);
  }

 private:
  std::chrono::milliseconds settle_;
  Display display_;
};

class WiredEye final : public Eye {
 public:
  WiredEye(const gige::Camera::Settings& settings, int retries) : camera_(settings), retries_(retries) {
    camera_.open();
  }

  [[nodiscard]] int width() const override { return camera_.settings().region.width; }
  [[nodiscard]] int height() const override { return camera_.settings().region.height; }
  [[nodiscard]] int bits() const override { return camera_.settings().converter_bits; }

  std::vector<std::uint16_t> take(double exposure_s) override {
    if (exposure_s != camera_.settings().exposure_s) camera_.set_exposure(exposure_s);
    std::string reason;
    for (int attempt = 0; attempt <= retries_; ++attempt) {
      auto result = camera_.take();
      ++frames;
      if (auto* const frame = std::get_if<gige::Frame>(&result)) return std::move(frame->dn);
      ++repeated;
      const auto& none = std::get<gige::NoFrame>(result);
      reason = none.text;
      using enum gige::NoFrame::Reason;
      if (none.reason == kNoAnswer || none.reason == kNotOwner) camera_.reconnect();
    }
    throw std::runtime_error(reason);
  }

  [[nodiscard]] const gige::Camera& camera() const { return camera_; }
  int frames = 0, repeated = 0;

 private:
  gige::Camera camera_;
  int retries_;
};

class WiredRails final : public Rails {
 public:
  explicit WiredRails(const std::string& line) : client_(settings_of(line)) {}

  void home() override {
    for (const int axis : {kLensAxis, kDisplayAxis}) client_.home_if_needed(axis);
  }
  void move_to(double lens_mm, double display_mm) override {
    // An axis that is there keeps its place: each approach repeats it to half a micrometre only.
    if (lens_mm != lens_mm_) client_.move_to_um(kLensAxis, 1e3 * lens_mm);
    lens_mm_ = lens_mm;
    client_.move_to_um(kDisplayAxis, 1e3 * display_mm);
  }

 private:
  static zaber::ClientSettings settings_of(const std::string& line) {
    zaber::ClientSettings settings;
    settings.line = line;
    return settings;
  }
  zaber::Client client_;
  double lens_mm_ = -1.0;
};

gige::Camera::Settings camera_settings(const WiredBenchSettings& settings) {
  gige::Camera::Settings camera;
  camera.address = settings.camera_address;
  camera.sensor_width = settings.width;
  camera.sensor_height = settings.height;
  camera.region = {0, 0, settings.width, settings.height};
  camera.converter_bits = settings.bits;
  camera.packet_size = settings.packet_size;
  camera.timeout_s = std::chrono::duration<double>(settings.timeout).count();
  return camera;
}

struct WiredTestbed::Parts {
  explicit Parts(const WiredBenchSettings& settings)
      : rails(settings.rails),
        screen(settings.display, settings.settle),
        eye(camera_settings(settings), settings.retries) {}

  WiredRails rails;
  WiredScreen screen;
  WiredEye eye;
};

WiredTestbed::WiredTestbed(const WiredBenchSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}
WiredTestbed::~WiredTestbed() = default;

Bench WiredTestbed::bench() {
  return {parts_->screen, parts_->eye, parts_->rails};
}

void WiredTestbed::identify(Validity& validity) const {
  const gige::Camera::Identity& camera = parts_->eye.camera().identity();
  validity.camera_vendor = camera.vendor;
  validity.camera_model = camera.model;
  validity.camera_serial = camera.serial;
  validity.emulated = camera.is_emulated();
}

std::string WiredTestbed::transport() const {
  return parts_->eye.camera().transport();
}
int WiredTestbed::frames() const {
  return parts_->eye.frames;
}
int WiredTestbed::repeated_frames() const {
  return parts_->eye.repeated;
}

}  // namespace
}  // namespace vbar::optical_stimulator::calibrate

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
  vbar::files::print_parse_errors_by_line(program);
  CLI11_PARSE(program, argc, argv);
  options.procedure.seed = options.seed;
  if (options.is_quick) options.procedure = calibrate::quick(options.procedure);
  std::signal(SIGPIPE, SIG_IGN);  // an X server that goes away is an error with a sentence
  try {
    return run(options);
  } catch (const std::exception& error) {
    vbar::files::print_error("vbar_os_calibrate", error.what());
    return kFailed;
  }
}
