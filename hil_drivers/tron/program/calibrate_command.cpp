#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "hil_drivers/tron/calibration/procedure.h"
#include "hil_drivers/tron/program/commands.h"
#include "hil_drivers/tron/program/wired_testbed.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "host_sim/simulation/exit_codes.h"

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
  fmt::print(stderr, "vbar tron check: the calibration is not valid any more: {}\n", result.reason);
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
