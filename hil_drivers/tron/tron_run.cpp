#include "hil_drivers/tron/tron_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/tron/geometry/pose_fusion.h"
#include "hil_drivers/tron/lights/room_light.h"
#include "hil_drivers/tron/motion_planning/arm_planner.h"
#include "hil_drivers/tron/tron_report.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/twins/camera/photometry.h"

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
  tron.on_failure = testbeds::read_on_failure(section);
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
  return testbeds::find_calibration_file(
      settings.calibration, data_directory, seed,
      {"testbed.tron", command, "a quarter of an hour of one processor (half of it with --quick)"});
}

std::filesystem::path replaced(std::string path, const std::filesystem::path& data_directory, std::uint64_t seed) {
  path = files::replaced(std::move(path), "{data}", data_directory.string());
  return files::replaced(std::move(path), "{seed}", std::to_string(seed));
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kDegree = 0.017453292519943295;
constexpr int kBinning = 2;
/// Chi-square of six degrees of freedom between arms and motion capture at the start: beyond it the calibration is of
/// another bench, or a mount has moved. One in 10^8 of the right ones.
constexpr double kForeignCalibration = 50.0;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

twins::camera::Region single_pixels(const twins::camera::Region& region) {
  return {kBinning * region.x, kBinning * region.y, kBinning * region.width, kBinning * region.height};
}

/// Returns the same pose at full scale.
Eigen::Isometry3d in_orbit(const Eigen::Isometry3d& T_C_T, double scale) {
  Eigen::Isometry3d T = T_C_T;
  T.translation() /= scale;
  return T;
}

}  // namespace

twins::camera::CameraSettings calibrated_camera(const Calibration& calibration,
                                                const twins::camera::CameraSettings& of_mission) {
  const LensCalibration& lens = calibration.lens;
  twins::camera::CameraSettings camera = of_mission;
  const double focal_px = 0.5 * (lens.fx_px + lens.fy_px) / kBinning;
  camera.optics.focal_length_mm = focal_px * camera.detector.pixel_pitch_um * 1e-3;
  // The calibration's pixels are those of its images, the region that the camera reads. An integer is the centre of a
  // pixel: two of them have theirs at 0.5.
  const twins::camera::Region region = single_pixels(of_mission.region);
  camera.optics.principal_point_px = {(region.x + lens.cx_px - 0.5) / kBinning,
                                      (region.y + lens.cy_px - 0.5) / kBinning};
  camera.optics.distortion = lens.distortion;
  if (calibration.camera.offset_dn > 0.0) camera.detector.offset_dn = calibration.camera.offset_dn;
  return camera;
}

TronRun::TronRun(const TronSettings& settings, const testbeds::RunContext& context)
    : CameraRun("tron", context, calibration_file(settings, context.data_directory, context.mission.seed),
                {"bench_s", &TronRow::bench_s}, settings.on_failure),
      settings_(settings),
      laboratory_file_(replaced(settings.laboratory, context.data_directory, context.mission.seed)) {}

TronRun::~TronRun() {
  close();
}

twins::camera::CameraSettings TronRun::calibrated_camera_of(const testbeds::CameraPlan& plan) {
  bench_ = read_testbed_design(laboratory_file_);
  calibration_ = load_calibration(calibration_file_);
  if (calibration_.validity.bench != bench_.name)
    throw error_of(fmt::format("{} is a calibration of the bench \"{}\", not of \"{}\"", calibration_file_.string(),
                               calibration_.validity.bench, bench_.name));
  const LensCalibration& lens = calibration_.lens;
  if (const auto region = single_pixels(plan.settings.region);
      region.width != lens.width_px || region.height != lens.height_px)
    throw error_of(fmt::format("{} reads {} x {} single pixels, binned by {}; {} holds for images of {} x {}",
                               plan.name, region.width, region.height, kBinning, calibration_file_.string(),
                               lens.width_px, lens.height_px));
  exposure_s_ = plan.settings.exposure_s * exposure_factor(bench_.lamp);
  return calibrated_camera(calibration_, plan.settings);
}

void TronRun::open() {
  open_devices();
  check_calibration();
}

void TronRun::open_devices() {
  const std::filesystem::path& data = context_.data_directory;
  DeviceSettings devices;
  devices.bench = bench_;
  devices.vicon_rotation = calibration_.vicon.rotation;
  devices.is_emulated = !settings_.bench.empty();
  devices.region = single_pixels(camera_.region);
  devices.exposure_s = exposure_s_;
  devices.converter_bits = calibration_.camera.bits;
  devices.packet_size = settings_.packet_size;
  devices.retries = settings_.retries;
  // An emulated camera draws its image on the computer of all others.
  constexpr int kEmulatedPatience = 20;
  devices.timeout = settings_.timeout * (devices.is_emulated ? kEmulatedPatience : 1);
  devices.settle_limit_s = settings_.settle_limit_s;
  devices.operator_timeout_s = static_cast<double>(settings_.operator_timeout.count());
  devices.report = [](const std::string& text) { std::cerr << "testbed tron: " << text << '\n'; };
  laboratory_ = std::make_unique<WiredDevices>(devices);

  TestbedAddresses addresses = addresses_of(bench_);
  if (!settings_.bench.empty()) {
    process_.emplace(settings_.bench + laboratory_->port_options(), context_.mission.seed, data);
    addresses = read_addresses(process_->addresses_file());
  }
  clock_ = addresses.is_virtual ? "virtual" : "real";
  if (!settings_.camera_address.empty()) addresses.camera = settings_.camera_address;
  if (!settings_.camera_robot_address.empty()) addresses.camera_robot.host = settings_.camera_robot_address;
  if (!settings_.target_robot_address.empty()) addresses.target_robot.host = settings_.target_robot_address;
  if (!settings_.lights_address.empty()) addresses.lights = parse_address(settings_.lights_address);
  laboratory_->open(addresses);

  const PhotometricTable table =
      calibration_.lights.empty() ? PhotometricTable() : PhotometricTable(calibration_.lights);
  laboratory_->set_light_values(
      [table, lamp = bench_.lamp](const LightLevels& levels) { return light_values(levels, lamp, table); });
  lights_.emplace(bench_, calibration_, table);
  PlacementSettings placement;
  placement.trials = settings_.trials;
  placement.max_hidden = settings_.max_hidden;
  placement.seed = context_.mission.seed;
  planner_.emplace(bench_, calibration_, placement, data);
  ExchangeSettings exchange;
  exchange.correct_above_m = 1e-3 * settings_.correct_above_mm;
  exchange.correct_above_rad = settings_.correct_above_deg * kDegree;
  exchange.fail_above_m = 1e-3 * settings_.fail_above_mm;
  exchange.fail_above_rad = settings_.fail_above_deg * kDegree;
  exchange.lamp_speed_rad_s = bench_.lamp.speed_rad_s;
  exchange_.emplace(exchange, calibration_, *planner_, *lights_, *laboratory_);
  const auto model = twins::camera::load_cad_model(mission::cad_source_of(data, bench_.target.model));
  finish_.emplace(camera_, model, exchange_->take_dark(exposure_s_).dn,
                  context_.mission.seed ^ engine::fnv1a_64(plan_->name + "/background"));
}

/// Arms and motion capture agree on where the target is, or the calibration is not of this bench.
void TronRun::check_calibration() {
  if (calibration_.validity.emulated != laboratory_->camera_is_emulated())
    throw std::runtime_error(fmt::format("{} is of {} bench, and the camera is of {} one", calibration_file_.string(),
                                         calibration_.validity.emulated ? "an emulated" : "a real",
                                         laboratory_->camera_is_emulated() ? "an emulated" : "a real"));
  const auto measured = laboratory_->measure();
  const auto* const place = std::get_if<MeasuredPlace>(&measured);
  if (place == nullptr) throw std::runtime_error("the robots were stopped at the start");
  if (!place->capture) return;
  PoseEstimate arms{T_C_T_of_arms(calibration_, place->posture)};
  PoseEstimate vicon{T_C_T_of_vicon(calibration_, place->capture->T_V_camera, place->capture->T_V_target)};
  arms.covariance = covariance_at(calibration_.covariance.arms, arms.T);
  vicon.covariance = covariance_at(calibration_.covariance.vicon, vicon.T);
  const double chi_square = fuse(arms, vicon).chi_square;
  if (!(chi_square <= kForeignCalibration))
    throw std::runtime_error(fmt::format(
        "{} is not of this bench, or a mount has moved: arms and motion capture disagree by a chi-square of {:.0f}, "
        "accepted is {:.0f}; make one with vbar_tron calibrate",
        calibration_file_.string(), chi_square, kForeignCalibration));
}

twins::camera::TakenImage TronRun::expose(const twins::camera::Exposure& exposure, TronRow& row) {
  twins::camera::TakenImage image = taken(exposure, row);
  if (row.pose_error_mm) image.notes.push_back({"pose_error_mm", *row.pose_error_mm});
  if (row.pose_error_deg) image.notes.push_back({"pose_error_deg", *row.pose_error_deg});
  image.failure = row.failure;
  return image;
}

/// An image whose failure the row states has no pixels.
twins::camera::TakenImage TronRun::taken(const twins::camera::Exposure& exposure, TronRow& row) {
  const auto scene = scene_of(exposure, bench_.target.model, bench_.scale);
  if (!scene) {
    row.failure = "the target has no attitude or is not in the scene";
    return {};
  }
  const auto exchanging = Clock::now();
  SceneImage taken = exchange_->take(*scene, exposure.number, exposure_s_, row);
  row.expose_wall_s = seconds_since(exchanging) - row.plan_wall_s - row.move_wall_s;
  if (!row.failure.empty()) return {};

  const auto finishing = Clock::now();
  std::optional<TargetLight> light;
  if (taken.is_lit) {
    light.emplace();
    const double sun = twins::camera::sun_photons(camera_.zero_magnitude_photons,
                                                  (exposure.sun_eci - exposure.camera_position_eci).norm());
    light->sun_C = scene->sun_C;
    light->sun_photons_per_m2_s = scene->sunlit * sun;
    light->earth_C = scene->earth_C;
    light->earth_photons_per_m2_s = scene->earth_to_sun * sun;
    light->earth_half_angle = scene->earth_half_angle;
  }
  FinishedImage finished = finish_->finish(taken.dn, exposure.number, in_orbit(taken.T_C_T, bench_.scale), light);
  row.light_level = finished.light_level;
  row.mask_wall_s = seconds_since(finishing);
  // Materials of the mock-up that are not the model's and the shadow of an arm leave a fifth or more of the sunlight.
  constexpr double kLampOff = 0.1;
  if (finished.sunlight_level && scene->sunlit > 0.5 && !(*finished.sunlight_level > kLampOff)) {
    row.failure = "the lamp is dark";
    return {};
  }
  return {std::move(finished.dn)};
}

void TronRun::stop() noexcept {
  if (laboratory_) laboratory_->stop();
}

void TronRun::close_devices() noexcept {
  if (laboratory_) laboratory_->close();
}

RunFigures TronRun::figures_of_run() {
  RunFigures figures;
  figures.clock = clock_;
  figures.files = {laboratory_file_, calibration_file_};
  if (laboratory_) {
    figures.is_emulated = laboratory_->camera_is_emulated();
    figures.camera = laboratory_->camera();
    figures.devices = laboratory_->counts();
  }
  std::error_code ignored;
  if (process_ && !folder_.empty())
    std::filesystem::copy_file(process_->directory() / "truth.csv", folder_ / "bench_truth.csv", ignored);
  return figures;
}

namespace {

std::shared_ptr<testbeds::TestbedRun> open(const mission::TestbedSettings& settings,
                                           const testbeds::RunContext& context) {
  return std::make_shared<TronRun>(dynamic_cast<const TronSettings&>(settings), context);
}

testbeds::CalibratedCamera calibrated(const mission::TestbedSettings& settings, const mission::Mission& mission,
                                      const std::filesystem::path& data_directory,
                                      const twins::camera::CameraSettings& of_mission) {
  const auto& own = dynamic_cast<const TronSettings&>(settings);
  const Calibration calibration = load_calibration(calibration_file(own, data_directory, mission.seed));
  return {calibrated_camera(calibration, of_mission), std::nullopt};
}

}  // namespace

const testbeds::TestbedKind kTron{{"tron", read_tron}, open, {tables, summarise, sections}, calibrated};

}  // namespace vbar::tron
