#include "hil_drivers/optical_stimulator/stimulator_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/optical_stimulator/stimulator_report.h"

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
  settings->on_failure = testbeds::read_on_failure(section);
  section.finish();
  return settings;
}

std::filesystem::path calibration_file(const OpticalStimulatorSettings& settings,
                                       const std::filesystem::path& data_directory, std::uint64_t seed) {
  return testbeds::find_calibration_file(settings.calibration, data_directory, seed,
                                         {"testbed.optical_stimulator", settings.bench.empty() ? kHardware : kEmulated,
                                          "some minutes (less than one with --quick)"});
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kBetweenRailChecks = 10;  // images

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A display of that rate shows whole frames: the light of an exposure that cuts one depends on when it begins.
void check_exposure(double exposure_s, double rate_hz) {
  const double frames = exposure_s * rate_hz;
  constexpr double kTolerance = 0.02;  // share of a frame: 2 parts in 1000 of the light of 0.2 s at 60 Hz
  if (std::abs(frames - std::round(frames)) > kTolerance)
    throw std::runtime_error(fmt::format(
        "an exposure of {} s is {:.2f} frames of a display of {} Hz, not a whole number of them; any_exposure = true "
        "allows it",
        exposure_s, frames, rate_hz));
}

}  // namespace

StimulatorRun::StimulatorRun(const OpticalStimulatorSettings& settings, const testbeds::RunContext& context)
    : CameraRun("optical_stimulator", context, calibration_file(settings, context.data_directory, context.mission.seed),
                {"render_s", &StimulatorRow::render_s}, settings.on_failure),
      settings_(settings) {}

StimulatorRun::~StimulatorRun() {
  close();
}

twins::camera::CameraSettings StimulatorRun::calibrated_camera_of(const testbeds::CameraPlan& plan) {
  calibration_ = load_calibration(calibration_file_);
  if (plan.settings.exposure_s != calibration_->validity.exposure_s)
    throw std::runtime_error(fmt::format("{}: it holds for exposures of {} s, and those of {} take {} s",
                                         calibration_file_.string(), calibration_->validity.exposure_s, plan.name,
                                         plan.settings.exposure_s));
  if (!settings_.any_exposure) check_exposure(plan.settings.exposure_s, calibration_->validity.display_rate_hz);
  return calibrated_camera(*calibration_, plan.settings);
}

void StimulatorRun::open() {
  if (!settings_.bench.empty()) process_.emplace(settings_.bench, context_.mission.seed, context_.data_directory);
  open_devices();
  check_bench();
}

void StimulatorRun::open_devices() {
  TestbedAddresses addresses;
  if (process_) addresses = read_addresses(process_->addresses_file());
  DevicePlan plan;
  plan.camera_address = settings_.camera_address.empty() ? addresses.camera : settings_.camera_address;
  plan.rails = settings_.rails.empty() ? addresses.rails : settings_.rails;
  plan.display.x_display = settings_.x_display.empty() ? addresses.display : settings_.x_display;
  plan.display.output = settings_.output;
  plan.display.width = calibration_->validity.display_width_px;
  plan.display.height = calibration_->validity.display_height_px;
  plan.region = region_with_strip(camera_.region);
  plan.exposure_s = camera_.exposure_s;
  plan.packet_size = settings_.packet_size;
  plan.packet_delay_us = settings_.packet_delay_us;
  plan.timeout = settings_.timeout;
  plan.retries = settings_.retries;
  devices_.emplace(plan, *calibration_);
}

/// The calibrated map, moved by the correction, and the frame strip by it.
void StimulatorRun::place_display(const DayCorrection& correction) {
  map_ = std::make_shared<const DisplayMap>(calibration_->geometry, correction);
  const auto region = region_with_strip(camera_.region);
  const twins::camera::Region strip{region.x, region.y, region.width, kStripRows};
  constexpr int kMargin_px = 2;
  strip_.emplace(region, *light_, camera_pixels(map_, camera_),
                 display_region(strip, camera_, *map_, light_->width(), light_->height(), kMargin_px),
                 settings_.white_electrons);
  ExchangeSettings exchange;
  exchange.width = region.width;
  exchange.settle = settings_.settle;
  exchange.display_frame = std::chrono::nanoseconds(std::llround(1e9 / calibration_->validity.display_rate_hz));
  exchange.gain_dn_per_electron = camera_.detector.gain_dn_per_electron;
  exchange.white_electrons = strip_->white_electrons();
  exchange.retries = settings_.retries;
  // Numbers go on: an image that still shows a picture of the self check must not pass.
  if (exchange_) exchange.first_frame = exchange_->next_frame();
  exchange_.emplace(exchange, *strip_, devices_->screen(), devices_->camera());
}

void StimulatorRun::check_bench() {
  light_.emplace(display_light(*calibration_, camera_.exposure_s));
  place_display({});
  self_check_ = SelfCheck(*calibration_, camera_, *map_, *light_).run(*exchange_);
  if (const std::string complaint = complaint_of(*self_check_); !complaint.empty())
    throw std::runtime_error("self check: " + complaint);
  place_display(self_check_->correction);
  pictures_.emplace(*calibration_, map_, *light_, plan_->settings, plan_->make_scene);
  picture_ = Picture(light_->width(), light_->height());
}

twins::camera::TakenImage StimulatorRun::expose(const twins::camera::Exposure& exposure, StimulatorRow& row) {
  const auto rendering = Clock::now();
  const PictureFigures figures = pictures_->draw(exposure, picture_);
  row.render_s = seconds_since(rendering);
  row.points = figures.points;
  row.wanted_electrons = figures.wanted_electrons;
  row.clipped_electrons = figures.clipped_electrons;
  ExchangedImage image = exchange_->take(picture_);
  row.frame = image.frame;
  row.tries = image.tries;
  row.stale = image.stale;
  row.packets_resent = image.packets_resent;
  row.reconnects = image.reconnects;
  row.show_s = image.show_s;
  row.receive_s = image.receive_s;
  row.strip_brightness = image.brightness;
  if (exposure.number % kBetweenRailChecks == 0) {
    if (const auto rails = devices_->check_rails()) {
      row.rail_lens_mm = rails->lens_mm;
      row.rail_display_mm = rails->display_mm;
    }
  }
  return {std::move(image.dn)};
}

void StimulatorRun::stop() noexcept {
  if (exchange_) exchange_->cancel();
  if (devices_) devices_->stop();
}

void StimulatorRun::close_devices() noexcept {
  devices_.reset();  // the display shows black, the camera is released
}

RunFigures StimulatorRun::figures_of_run() {
  RunFigures figures;
  figures.calibration_file = calibration_file_;
  figures.calibration = &*calibration_;
  if (self_check_) figures.self_check = *self_check_;
  if (devices_) figures.devices = devices_->identity();
  return figures;
}

namespace {

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<StimulatorRun>(dynamic_cast<const OpticalStimulatorSettings&>(settings), context);
}

testbeds::CalibratedCamera calibrated(const mission::TestbedSettings& settings, const mission::Mission& mission,
                                      const std::filesystem::path& data_directory,
                                      const twins::camera::CameraSettings& of_mission) {
  const auto& own = dynamic_cast<const OpticalStimulatorSettings&>(settings);
  const StimulatorCalibration calibration = load_calibration(calibration_file(own, data_directory, mission.seed));
  return {calibrated_camera(calibration, of_mission), calibration.centroid_floor_px};
}

}  // namespace

const testbeds::TestbedKind kOpticalStimulator{
    {"optical_stimulator", read_optical_stimulator}, open, {tables, summarise, sections}, calibrated, nullptr, true};

}  // namespace vbar::optical_stimulator
