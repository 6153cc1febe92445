#include "hil_drivers/tron/settings.h"

#include "hil_drivers/bench_process/bench_calibration_file.h"
#include "host_sim/files/replaced.h"

namespace vbar::tron {

using mission::above_to;
using mission::from_to;
using mission::TableReader;

std::shared_ptr<const mission::TestbedSettings> read_tron(const TableReader& section) {
  auto settings = std::make_shared<TronSettings>();
  TronSettings& tron = *settings;
  tron.bench = section.text("bench", "");
  tron.laboratory = section.text("laboratory", tron.laboratory);
  tron.calibration = section.text("calibration");
  tron.camera_address = section.text("camera", "");
  tron.camera_robot_address = section.text("camera_robot", "");
  tron.target_robot_address = section.text("target_robot", "");
  tron.lights_address = section.text("lights", "");
  tron.trials = static_cast<int>(section.integer("trials", 1, 100'000, tron.trials));
  tron.max_hidden = static_cast<int>(section.integer("max_hidden", 0, 12, tron.max_hidden));
  tron.settle_limit_s = section.number("settle_limit_s", above_to(0.0, 600.0), tron.settle_limit_s);
  tron.correct_above_mm = section.number("correct_above_mm", from_to(0.0, 1000.0), tron.correct_above_mm);
  tron.correct_above_deg = section.number("correct_above_deg", from_to(0.0, 180.0), tron.correct_above_deg);
  tron.fail_above_mm = section.number("fail_above_mm", above_to(0.0, 1000.0), tron.fail_above_mm);
  tron.fail_above_deg = section.number("fail_above_deg", above_to(0.0, 180.0), tron.fail_above_deg);
  tron.retries = static_cast<int>(section.integer("retries", 0, 20, tron.retries));
  tron.packet_size = static_cast<int>(section.integer("packet_size", 576, 9000, tron.packet_size));
  tron.timeout = std::chrono::milliseconds(section.integer("timeout_ms", 100, 600'000, tron.timeout.count()));
  tron.operator_timeout =
      std::chrono::seconds(section.integer("operator_timeout_s", 1, 100'000, tron.operator_timeout.count()));
  section.finish();
  return settings;
}

std::filesystem::path calibration_file(const TronSettings& settings, const std::filesystem::path& data_directory,
                                       std::uint64_t seed) {
  const std::string laboratory = replaced(settings.laboratory, data_directory, seed).string();
  const std::filesystem::path folder = replaced(settings.calibration, data_directory, seed).parent_path();
  std::string command = "vbar tron calibrate " + laboratory + " --seed {N} --out " + (folder / "").string();
  if (!settings.bench.empty())
    command += " --bench \"vbar_tron_bench {data}/benches/tron_emulated.toml --directory {directory} --seed {seed}\"";
  return bench_process::bench_calibration_file(
      settings.calibration, data_directory, seed,
      {"testbed.tron", command, "a quarter of an hour of one processor (half of it with --quick)"});
}

std::filesystem::path replaced(std::string path, const std::filesystem::path& data_directory, std::uint64_t seed) {
  path = files::replaced(std::move(path), "{data}", data_directory.string());
  return files::replaced(std::move(path), "{seed}", std::to_string(seed));
}

}  // namespace vbar::tron
