#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/tron/calibration/procedure.h"
#include "hil_drivers/tron/laboratory.h"
#include "hil_drivers/tron/motion_planning/arm_planner.h"
#include "hil_drivers/tron/program/commands.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::tron::calibrate {
namespace {

// Testbed under calibration, over its wires.

struct WiredBenchSettings {
  TestbedDesign bench;
  std::string bench_command;  ///< command line of an emulator; empty: the laboratory of the bench file
  std::uint64_t seed = 1;
  std::filesystem::path data_directory;
  twins::camera::Region region{160, 100, 1600, 1000};
  int bits = 12;
  std::function<void(const std::string&)> report;  ///< sentences for the operator
};

class WiredTestbed final : public CalibrationTestbed {
 public:
  /// Starts an emulator and opens all devices. Throws std::runtime_error.
  explicit WiredTestbed(const WiredBenchSettings& settings);

  [[nodiscard]] TestbedIdentity identity() override;
  void mount(Mounted what) override;
  [[nodiscard]] bool move(const Posture& posture) override;
  [[nodiscard]] MeasuredPosture measure() override;
  void light(const LightShares& shares) override;
  [[nodiscard]] CalibrationImage take(double exposure_s) override;

  /// Returns the emulator's table of true poses, which exists until this object ends; empty for a real testbed.
  [[nodiscard]] std::filesystem::path truth() const;

 private:
  WiredBenchSettings settings_;
  WiredDevices laboratory_;
  std::optional<testbeds::EmulatorProcess> process_;
  std::filesystem::path control_;
  TestbedBodies bodies_;
  PathPlanner paths_;
  double lamp_azimuth_rad_;
};

constexpr int kTries = 3;               ///< tries of a motion that the controllers interrupt
constexpr double kLightsDelay_s = 0.1;  ///< bench time: nothing acknowledges a lighting level
constexpr std::chrono::seconds kControlPatience{10};

DeviceSettings device_settings(const WiredBenchSettings& settings) {
  DeviceSettings devices;
  devices.bench = settings.bench;
  devices.vicon_rotation = settings.bench.vicon.rotation;
  devices.is_emulated = !settings.bench_command.empty();
  devices.region = settings.region;
  devices.converter_bits = settings.bits;
  devices.report = settings.report;
  // An emulated camera draws its images meanwhile, on a computer that may be busy.
  if (devices.is_emulated) devices.timeout = std::chrono::seconds(60);
  return devices;
}

/// A line to the control socket of an emulator, and its answer.
std::string answer_of(const std::filesystem::path& socket, const std::string& line) {
  const auto deadline = io::Clock::now() + kControlPatience;
  const auto channel = io::connect_unix(socket.string(), deadline);
  const std::string text = line + "\n";
  channel->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, deadline);
  std::string answer;
  while (answer.find('\n') == std::string::npos) {
    const auto bytes = channel->read(deadline);
    if (bytes.empty()) throw std::runtime_error("the emulated bench does not answer on its control line");
    answer.append(bytes.begin(), bytes.end());
  }
  return answer;
}

WiredTestbed::WiredTestbed(const WiredBenchSettings& settings)
    : settings_(settings),
      laboratory_(device_settings(settings)),
      bodies_(settings.bench),
      paths_(settings.bench, bodies_),
      lamp_azimuth_rad_(settings.bench.lamp.azimuth_low_rad) {
  TestbedAddresses addresses = addresses_of(settings.bench);
  if (!settings.bench_command.empty()) {
    process_.emplace(settings.bench_command + laboratory_.port_options(), settings.seed, settings.data_directory);
    addresses = read_addresses(process_->addresses_file());
    control_ = addresses.control;
  }
  laboratory_.open(addresses);
}

TestbedIdentity WiredTestbed::identity() {
  TestbedIdentity identity;
  identity.is_emulated = laboratory_.camera_is_emulated();
  // Vendor, model, serial number.
  const std::string camera = laboratory_.camera();
  const auto comma = camera.rfind(", ");
  identity.camera_model = camera.substr(0, comma);
  if (comma != std::string::npos) identity.camera_serial = camera.substr(comma + 2);
  return identity;
}

void WiredTestbed::mount(Mounted what) {
  const std::string name = what == Mounted::kBoard ? "board" : "target";
  if (!control_.empty()) {
    const std::string answer = answer_of(control_, fmt::format(R"({{"do": "mount", "what": "{}"}})", name));
    if (answer.find("\"" + name + "\"") == std::string::npos)
      throw std::runtime_error("the emulated bench does not mount the " + name + ": " + answer);
    return;
  }
  std::cout << (what == Mounted::kBoard ? "Mount the calibration board on the plate of the target's arm"
                                        : "Mount the mock-up on the plate of the target's arm")
            << ", leave the room and press Enter." << std::endl;
  std::string line;
  if (!std::getline(std::cin, line)) throw std::runtime_error("nobody confirmed that the " + name + " is mounted");
}

bool WiredTestbed::move(const Posture& posture) {
  for (int k = 0; k < kTries; ++k) {
    const auto path = paths_.plan(laboratory_.posture(), posture);
    if (std::holds_alternative<PathFailure>(path)) return false;
    if (laboratory_.follow(motion_along(std::get<Path>(path))) == MotionEnd::kArrived) return true;
    laboratory_.recover();
  }
  throw std::runtime_error(fmt::format("the robots interrupted a motion {} times", kTries));
}

MeasuredPosture WiredTestbed::measure() {
  for (int k = 0; k < kTries; ++k) {
    const auto measured = laboratory_.measure();
    if (std::holds_alternative<MeasuredPlace>(measured)) {
      const auto& place = std::get<MeasuredPlace>(measured);
      MeasuredPosture result{place.posture, std::nullopt};
      if (place.capture) result.vicon = ViconObjects{place.capture->T_V_camera, place.capture->T_V_target};
      return result;
    }
    laboratory_.recover();
  }
  throw std::runtime_error(fmt::format("the robots interrupted a measurement {} times", kTries));
}

void WiredTestbed::light(const LightShares& shares) {
  // The laboratory's table of light is not set: a power is the share of the largest value.
  LightLevels levels;
  levels.lamp_power = shares.lamp;
  levels.lamp_azimuth_rad = shares.lamp > 0.0 ? shares.lamp_azimuth_rad : lamp_azimuth_rad_;
  levels.box_power = shares.boxes;
  laboratory_.light(levels);
  const double travel_s = std::abs(levels.lamp_azimuth_rad - lamp_azimuth_rad_) / settings_.bench.lamp.speed_rad_s;
  lamp_azimuth_rad_ = levels.lamp_azimuth_rad;
  for (int k = 0; laboratory_.hold(kLightsDelay_s + travel_s) == MotionEnd::kInterrupted; ++k) {
    if (k == kTries) throw std::runtime_error(fmt::format("the robots interrupted a pause {} times", kTries));
    laboratory_.recover();
  }
}

CalibrationImage WiredTestbed::take(double exposure_s) {
  CalibrationImage image{settings_.region.width, settings_.region.height, settings_.bits,
                         laboratory_.take(exposure_s).dn};
  if (image.dn.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw std::runtime_error(
        fmt::format("camera: an image of {} pixels, expected {} x {}", image.dn.size(), image.width, image.height));
  return image;
}

std::filesystem::path WiredTestbed::truth() const {
  return process_ ? process_->directory() / "truth.csv" : std::filesystem::path();
}

}  // namespace
}  // namespace vbar::tron::calibrate

namespace vbar::tron {
namespace {

using namespace calibrate;

/// Exit code of both commands, beside those of vbar: the figures miss their limits.
constexpr int kMissed = 3;
/// Against the board's pose by the image, medians of the fused pose: the paper's figures.
constexpr double kTranslationGoal_mm = 2.9, kRotationGoal_deg = 0.35, kPixelGoal_px = 2.0;

struct Options {
  std::filesystem::path bench, out, data, truth, calibration;
  std::string bench_command;
  std::uint64_t seed = 1;
  int poses = 20;
  bool is_quick = false, has_no_lights = false;
};

const twins::camera::Region kRegion{160, 100, 1600, 1000};

LensCalibration designed_lens(const TestbedDesign& file) {
  return lens_as_designed(
      sensors::load_camera(mission::data_directory() / "cameras" / (file.camera.file + ".toml")).settings(), kRegion);
}

class Clock {
 public:
  void print(const std::string& line) const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    fmt::print("{:6.1f} s  {}\n", passed.count(), line);
    std::fflush(stdout);
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void write_text(const std::string& text, const std::filesystem::path& file) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.flush();
  if (!stream) throw files::write_error(file);
}

WiredBenchSettings wired_settings(const Options& options, const TestbedDesign& file, const Clock& clock) {
  WiredBenchSettings settings;
  settings.bench = file;
  settings.bench_command = options.bench_command;
  settings.seed = options.seed;
  settings.data_directory = mission::data_directory();
  settings.region = kRegion;
  settings.report = [&clock](const std::string& line) { clock.print(line); };
  return settings;
}

/// Measures, and keeps the raw data at once.
void measure(const Options& options, const TestbedDesign& file, const std::filesystem::path& data_file,
             const std::filesystem::path& truth_file, const Clock& clock) {
  ProcedureSettings settings;
  settings.seed = options.seed;
  if (options.is_quick) settings = quick(settings);
  if (options.has_no_lights) settings.light_levels = 0;
  clock.print(
      fmt::format("{}: {} postures of the board, then {} levels of each source of light; postures are chosen "
                  "first, without a move",
                  file.name, settings.fitted + settings.judged, settings.light_levels));
  WiredTestbed bench(wired_settings(options, file, clock));
  CalibrationData data = measure_testbed(bench, file, designed_lens(file), settings, free_postures(file),
                                         [&](const std::string& line) { clock.print(line); });
  data.validity.date_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  save_data(data, data_file);
  if (!bench.truth().empty())
    std::filesystem::copy_file(bench.truth(), truth_file, std::filesystem::copy_options::overwrite_existing);
}

void print_figures(const StageFigures& stage) {
  const auto row = [](const char* against, const ErrorFigures& f) {
    fmt::print("    {:<6} {:6.2f} ± {:.2f} ({:.2f}) mm  {:.3f} ± {:.3f} ({:.3f}) deg  {:.2f} ± {:.2f} ({:.2f}) px\n",
               against, f.translation_mean_mm, f.translation_sigma_mm, f.translation_median_mm, f.rotation_mean_deg,
               f.rotation_sigma_deg, f.rotation_median_deg, f.pixel_mean_px, f.pixel_sigma_px, f.pixel_median_px);
  };
  fmt::print("{}, {} postures\n", stage.stage, stage.poses);
  row("board", stage.board);
  if (stage.truth) row("truth", *stage.truth);
}

int calibrate_command(const Options& options) {
  const Clock clock;
  const TestbedDesign file = read_testbed_design(options.bench);
  // Before a measurement of an hour, which a folder that cannot be made would lose.
  std::filesystem::create_directories(options.out);
  const bool is_fit_only = !options.data.empty();
  const std::filesystem::path data_file = is_fit_only ? options.data : options.out / "calibration_data.json";
  std::filesystem::path truth_file = options.truth;
  if (!is_fit_only) {
    truth_file = options.out / "truth.csv";
    measure(options, file, data_file, truth_file, clock);
  }
  CalibrationData data = load_data(data_file);
  if (!truth_file.empty() && std::filesystem::exists(truth_file)) {
    const int known = add_truth(data.judged, truth_file, T_target_board(file));
    clock.print(fmt::format("true poses of {} of {} judged postures, for the figures only", known, data.judged.size()));
  }
  const TestbedFit fit =
      calibrate::calibrate(data, file, designed_lens(file), files::sha256_of_file(data_file).value_or(""),
                           [&](const std::string& line) { clock.print(line); });
  save_calibration(fit.calibration, options.out / "calibration.toml");
  write_text(calibration_page(fit, data), options.out / "calibration.html");
  for (const StageFigures& stage : fit.calibration.figures) print_figures(stage);
  clock.print((options.out / "calibration.toml").string());
  const ErrorFigures& fused = fit.calibration.figures.back().board;
  const bool is_reached = fused.translation_median_mm <= kTranslationGoal_mm &&
                          fused.rotation_median_deg <= kRotationGoal_deg && fused.pixel_median_px <= kPixelGoal_px;
  if (is_reached) return app::kDone;
  fmt::print(stderr, "vbar tron calibrate: the medians of the fused pose miss {} mm, {} deg or {} px\n",
             kTranslationGoal_mm, kRotationGoal_deg, kPixelGoal_px);
  return kMissed;
}

int check_command(const Options& options) {
  const Clock clock;
  const TestbedDesign file = read_testbed_design(options.bench);
  const Calibration calibration = load_calibration(options.calibration);
  if (calibration.validity.bench != file.name)
    throw app::Refused(fmt::format("{} is a calibration of the bench {}, not of {}", options.calibration.string(),
                                   calibration.validity.bench, file.name));
  WiredTestbed bench(wired_settings(options, file, clock));
  const CheckResult result = check(bench, file, calibration, options.poses, options.seed, free_postures(file),
                                   [&](const std::string& line) { clock.print(line); });
  print_figures(result.figures);
  fmt::print("limits of the medians: {:.2f} mm, {:.3f} deg, {:.2f} px; beyond the gate of fusion: {} of {}\n",
             result.translation_limit_mm, result.rotation_limit_deg, result.pixel_limit_px, result.beyond_gate,
             result.figures.poses);
  if (result.is_valid) {
    fmt::print("the calibration is valid\n");
    return app::kDone;
  }
  files::print_error("vbar tron check", fmt::format("the calibration is not valid any more: {}", result.reason));
  return kMissed;
}

}  // namespace

void add_calibrate_commands(CLI::App& program, int& exit_code) {
  const auto options = std::make_shared<Options>();
  const auto add_common = [&](CLI::App* command) {
    command->add_option("bench", options->bench, "bench file (TOML)")->required();
    command->add_option("--bench", options->bench_command,
                        "command line that starts an emulated bench; {data}, {directory} and {seed} are replaced");
    command->add_option("--seed", options->seed, "of the choice of postures and of the emulated bench");
  };
  CLI::App* measure = program.add_subcommand(
      "calibrate", "measures a bench and writes its calibration; exit code 3: its figures miss their goals");
  add_common(measure);
  measure->add_option("--out", options->out, "folder for calibration.toml, its page and the raw data")->required();
  measure->add_option("--fit-only", options->data, "repeat the fit of these data (calibration_data.json)");
  measure->add_option("--truth", options->truth, "with --fit-only: table of true poses of an emulated bench");
  measure->add_flag("--quick", options->is_quick, "fewer postures, for a test of the whole path");
  measure->add_flag("--no-lights", options->has_no_lights, "poses only; sources of light are taken as designed");
  measure->callback([options, &exit_code] { exit_code = calibrate_command(*options); });
  CLI::App* again =
      program.add_subcommand("check", "measures a few postures; exit code 3: the calibration is not valid any more");
  add_common(again);
  again->add_option("--calibration", options->calibration, "calibration file (TOML)")->required();
  again->add_option("--poses", options->poses, "postures to measure")->check(CLI::Range(5, 1000));
  again->callback([options, &exit_code] { exit_code = check_command(*options); });
}

}  // namespace vbar::tron
