#include "hil_drivers/optical_stimulator/settings.h"

#include <cmath>

#include "hil_drivers/bench_process/bench_calibration_file.h"

namespace vbar::optical_stimulator {
namespace {

using mission::from_to;
using mission::TableReader;

std::chrono::nanoseconds milliseconds(const TableReader& section, std::string_view key, double high, double otherwise) {
  return std::chrono::nanoseconds(std::llround(1e6 * section.number(key, from_to(0.0, high), otherwise)));
}

/// Without a testbed that names it, the address of a device is required.
std::string address(const TableReader& section, std::string_view key, bool is_required) {
  const std::string value = section.text(key, "");
  if (is_required && value.empty()) section.refuse(key, "nothing", "an address, as no bench names one");
  return value;
}

constexpr const char* kEmulated =
    "vbar os_calibrate --seed {N} --out {out} "
    "--bench \"vbar_os_bench {data}/benches/optical_stimulator.toml --directory {directory} --seed {seed}\"";
constexpr const char* kHardware = "vbar os_calibrate --camera IP --x-display :0 --rails LINE --out {out}";

}  // namespace

std::shared_ptr<const mission::TestbedSettings> read_optical_stimulator(const TableReader& section) {
  auto settings = std::make_shared<OpticalStimulatorSettings>();
  settings->bench = section.text("bench", "");
  const bool is_required = settings->bench.empty();
  settings->calibration = section.text("calibration");
  settings->camera_address = address(section, "camera", is_required);
  settings->x_display = address(section, "display", is_required);
  settings->output = section.text("output", "");
  settings->rails = section.text("rails", "");
  settings->packet_size = static_cast<int>(section.integer("packet_size", 576, 9000, settings->packet_size));
  if (const auto delay_us = section.integer("packet_delay_us", 0, 100'000, 0); delay_us > 0)
    settings->packet_delay_us = static_cast<int>(delay_us);
  settings->settle = milliseconds(section, "settle_ms", 10'000.0, 35.0);
  settings->timeout =
      std::chrono::duration_cast<std::chrono::milliseconds>(milliseconds(section, "timeout_ms", 60'000.0, 3000.0));
  settings->retries = static_cast<int>(section.integer("retries", 0, 20, settings->retries));
  settings->any_exposure = section.flag("any_exposure", false);
  settings->white_electrons = section.number("strip_electrons", from_to(1000.0, 1e6), settings->white_electrons);
  section.finish();
  return settings;
}

std::filesystem::path calibration_file(const OpticalStimulatorSettings& settings,
                                       const std::filesystem::path& data_directory, std::uint64_t seed) {
  return bench_process::bench_calibration_file(
      settings.calibration, data_directory, seed,
      {"testbed.optical_stimulator", settings.bench.empty() ? kHardware : kEmulated,
       "some minutes (less than one with --quick)"});
}

}  // namespace vbar::optical_stimulator
