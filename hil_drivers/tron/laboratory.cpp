#include "hil_drivers/tron/laboratory.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/tron/protocols/sacn.h"
#include "hil_drivers/tron/protocols/vicon_receiver.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "hil_drivers/tron/robot/robot_pair.h"

namespace vbar::tron {

TcpAddress parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  TcpAddress address;
  if (colon != std::string::npos && colon > 0) {
    address.host = text.substr(0, colon);
    const char* const end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data() + colon + 1, end, address.port);
    if (error == std::errc() && last == end && address.port > 0) return address;
  }
  throw std::runtime_error("\"" + text + "\" is not an address host:port");
}

TestbedAddresses addresses_of(const TestbedDesign& bench) {
  TestbedAddresses addresses;
  addresses.camera = bench.camera_address;
  addresses.camera_robot = {bench.camera_robot.line.address, bench.camera_robot.line.eki_port};
  addresses.target_robot = {bench.target_robot.line.address, bench.target_robot.line.eki_port};
  addresses.lights = {bench.sacn.address, bench.sacn.port};
  return addresses;
}

TestbedAddresses read_addresses(const std::filesystem::path& file) {
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    TestbedAddresses addresses;
    addresses.is_virtual = json.at("clock").get<std::string>() == "virtual";
    addresses.camera = json.at("camera").get<std::string>();
    addresses.camera_robot = parse_address(json.at("camera_robot").at("eki").get<std::string>());
    addresses.target_robot = parse_address(json.at("target_robot").at("eki").get<std::string>());
    addresses.lights = parse_address(json.at("sacn").get<std::string>());
    addresses.control = json.at("control").get<std::string>();
    return addresses;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
}

namespace {

constexpr int kFrames = 20;     // frames of motion capture, averaged
constexpr int kMoreCycles = 3;  // until the last of them has certainly been sent
constexpr double kMoved_rad = 1e-6, kMoved_m = 1e-6;

RobotPairSettings robot_settings(const DeviceSettings& settings, std::function<void(std::uint64_t)> on_cycle) {
  RobotPairSettings pair;
  pair.on_cycle = std::move(on_cycle);
  const TestbedDesign& bench = settings.bench;
  const auto rsi_of = [&](const char* name, const char* file, const Robot& robot, const Track* track) {
    auto rsi = rsi::client_settings(name, robot, track, robot_files(file));
    if (settings.is_emulated) rsi.port = 0;
    return rsi;
  };
  pair.camera_rsi = rsi_of("camera robot", kCameraRobot, bench.camera_robot, &bench.track);
  pair.target_rsi = rsi_of("target robot", kTargetRobot, bench.target_robot, nullptr);
  pair.track_home_m = bench.track.home_m;
  pair.settle_limit_s = settings.settle_limit_s;
  pair.operator_timeout_s = settings.operator_timeout_s;
  return pair;
}

ViconSettings vicon_settings(const DeviceSettings& settings) {
  ViconSettings vicon = settings.bench.vicon;
  if (settings.is_emulated) vicon.port = 0;
  return vicon;
}

eki::ClientSettings eki_settings(const char* name, const TcpAddress& address, std::chrono::milliseconds timeout) {
  eki::ClientSettings settings;
  settings.name = name;
  settings.host = address.host;
  settings.port = address.port;
  settings.connect_limit = std::max(settings.connect_limit, timeout);
  settings.answer_limit = std::max(settings.answer_limit, timeout);
  return settings;
}

gige::Camera::Settings camera_settings(const DeviceSettings& settings, const std::string& address) {
  gige::Camera::Settings camera;
  camera.address = address;
  camera.model = settings.bench.camera.model;
  camera.serial = settings.bench.camera.serial;
  camera.exposure_s = settings.exposure_s;
  camera.region = settings.region;
  camera.converter_bits = settings.converter_bits;
  camera.packet_size = settings.packet_size;
  camera.timeout_s = std::chrono::duration<double>(settings.timeout).count();
  return camera;
}

/// Light proportional to the value: until a calibration says otherwise.
std::array<std::uint16_t, 2 + kBoxes> proportional(const LightLevels& levels, const Lamp& lamp) {
  const auto value = [](double share) {
    return static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(share, 0.0, 1.0)));
  };
  std::array<std::uint16_t, 2 + kBoxes> values{};
  values[0] = value(levels.lamp_power);
  const double arc_rad = lamp.azimuth_high_rad - lamp.azimuth_low_rad;
  values[1] = arc_rad > 0.0 ? value((levels.lamp_azimuth_rad - lamp.azimuth_low_rad) / arc_rad) : std::uint16_t{0};
  for (std::size_t k = 0; k < kBoxes; ++k) values[2 + k] = value(levels.box_power[k]);
  return values;
}

}  // namespace

struct WiredDevices::Parts {
  explicit Parts(const DeviceSettings& of)
      : settings(of),
        robots(robot_settings(of, [this](std::uint64_t cycles) { keep_lights(cycles); })),
        capture(vicon_settings(of), of.vicon_rotation),
        values([lamp = of.bench.lamp](const LightLevels& levels) { return proportional(levels, lamp); }) {}

  [[nodiscard]] vicon::Moved moved(const Posture& now) {
    vicon::Moved result;
    if (measured_last) {
      result.camera = (now.camera_rad - measured_last->camera_rad).cwiseAbs().maxCoeff() > kMoved_rad ||
                      std::abs(now.carriage_m - measured_last->carriage_m) > kMoved_m;
      result.target = (now.target_rad - measured_last->target_rad).cwiseAbs().maxCoeff() > kMoved_rad;
    }
    measured_last = now;
    return result;
  }

  /// Keeps the source alive: a receiver drops a source that it has not heard for 2.5 s.
  void keep_lights(std::uint64_t cycles) {
    constexpr auto kEvery = static_cast<std::uint64_t>(sacn::Sender::kKeepAliveSeconds / rsi::kCycle_s);
    if (cycles % kEvery != 0) return;
    const std::scoped_lock lock(lights_mutex);
    if (lights) lights->keep_alive();
  }

  void send(const std::array<std::uint16_t, 2 + kBoxes>& light_values) {
    const std::scoped_lock lock(lights_mutex);
    lights->send(light_values);
  }

  /// A camera may be silent for some seconds: its cable was moved, or the computer of an emulated one is busy.
  void reconnect_camera() {
    constexpr std::chrono::seconds kAbsence{10};
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      try {
        return camera->reconnect();
      } catch (const gige::CameraError&) {
        if (std::chrono::steady_clock::now() - begin > kAbsence) throw;
      }
    }
  }

  void end_lights() {
    const std::scoped_lock lock(lights_mutex);
    lights.reset();  // three packets end the source: dark
  }

  DeviceSettings settings;
  std::mutex lights_mutex;  // the thread that holds the arms keeps the lights
  std::optional<sacn::Sender> lights;
  RobotPair robots;
  vicon::Receiver capture;
  std::optional<gige::Camera> camera;
  std::function<std::array<std::uint16_t, 2 + kBoxes>(const LightLevels&)> values;
  std::optional<Posture> measured_last;
  double exposure_s = 0.0;
  bool is_virtual = false;
  std::int64_t frames = 0, retries = 0;
};

WiredDevices::WiredDevices(const DeviceSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}

WiredDevices::~WiredDevices() {
  close();
}

std::string WiredDevices::port_options() const {
  return fmt::format(" --camera-rsi-port {} --target-rsi-port {} --vicon-port {}", parts_->robots.camera_rsi_port(),
                     parts_->robots.target_rsi_port(), parts_->capture.port());
}

void WiredDevices::open(const TestbedAddresses& addresses) {
  Parts& parts = *parts_;
  const DeviceSettings& settings = parts.settings;
  parts.is_virtual = addresses.is_virtual;
  SacnSettings sacn = settings.bench.sacn;
  sacn.address = addresses.lights.host;
  sacn.port = addresses.lights.port;
  parts.lights.emplace(sacn, settings.bench.name);
  parts.camera.emplace(camera_settings(settings, addresses.camera));
  parts.exposure_s = settings.exposure_s;
  parts.camera->open();
  parts.robots.open(eki_settings("camera robot", addresses.camera_robot, settings.timeout),
                    eki_settings("target robot", addresses.target_robot, settings.timeout), addresses.is_virtual);
}

void WiredDevices::close() noexcept {
  Parts& parts = *parts_;
  parts.end_lights();
  parts.robots.close();
  if (parts.camera) parts.camera->close();
}

void WiredDevices::stop() noexcept {
  parts_->robots.cancel();
  if (parts_->camera) parts_->camera->stop();
}

Posture WiredDevices::posture() {
  return parts_->robots.command();
}

MotionEnd WiredDevices::follow(const Motion& motion) {
  return parts_->robots.follow(motion);
}

MotionEnd WiredDevices::hold(double bench_s) {
  return parts_->robots.hold(std::max(1, static_cast<int>(std::ceil(bench_s / rsi::kCycle_s))));
}

void WiredDevices::recover() {
  parts_->robots.recover(parts_->settings.report);
}

std::variant<MeasuredPlace, MotionEnd> WiredDevices::measure() {
  Parts& parts = *parts_;
  parts.capture.clear();
  const double frames_s = kFrames / parts.settings.bench.vicon.rate_hz;
  const int cycles = static_cast<int>(std::ceil(frames_s / rsi::kCycle_s)) + kMoreCycles;
  if (parts.robots.hold(cycles) == MotionEnd::kInterrupted) return MotionEnd::kInterrupted;
  if (parts.is_virtual) {
    parts.capture.drain();
  } else {
    parts.capture.wait_for(kFrames, parts.settings.timeout);
  }
  MeasuredPlace place;
  place.posture = parts.robots.rest_posture();
  const vicon::CaptureAverage average = parts.capture.average(kFrames, parts.moved(place.posture));
  if (average.is_tracked()) place.capture = CapturedPoses{average.camera.T_V_object, average.target.T_V_object};
  return place;
}

void WiredDevices::light(const LightLevels& levels) {
  light_values(parts_->values(levels));
}

void WiredDevices::light_values(const std::array<std::uint16_t, 2 + kBoxes>& values) {
  parts_->send(values);
}

void WiredDevices::set_light_values(std::function<std::array<std::uint16_t, 2 + kBoxes>(const LightLevels&)> values) {
  parts_->values = std::move(values);
}

DetectorFrame WiredDevices::take(double exposure_s) {
  Parts& parts = *parts_;
  if (exposure_s != parts.exposure_s) {
    parts.camera->set_exposure(exposure_s);
    parts.exposure_s = exposure_s;
  }
  gige::NoFrame last;
  for (int k = 1; k <= 1 + parts.settings.retries; ++k) {
    auto result = parts.camera->take();
    if (auto* const frame = std::get_if<gige::Frame>(&result)) {
      ++parts.frames;
      return {std::move(frame->dn), frame->packets_resent, k};
    }
    last = std::get<gige::NoFrame>(result);
    ++parts.retries;
    using enum gige::NoFrame::Reason;
    if (last.reason == kStopped) break;
    if (last.reason == kNoAnswer || last.reason == kNotOwner) parts.reconnect_camera();
  }
  throw std::runtime_error(last.text);
}

double WiredDevices::time_s() const {
  return parts_->robots.time_s();
}

std::string WiredDevices::camera() const {
  if (!parts_->camera) return "";
  const gige::Camera::Identity& camera = parts_->camera->identity();
  return fmt::format("{} {}, serial number {}", camera.vendor, camera.model, camera.serial);
}

std::string WiredDevices::camera_model() const {
  return parts_->camera ? parts_->camera->identity().model : "";
}

std::string WiredDevices::camera_serial() const {
  return parts_->camera ? parts_->camera->identity().serial : "";
}

bool WiredDevices::camera_is_emulated() const {
  return parts_->camera && parts_->camera->identity().is_emulated();
}

std::map<std::string, double> WiredDevices::counts() const {
  const RobotPairCounts robots = parts_->robots.counts();
  const vicon::CaptureCounts capture = parts_->capture.counts();
  const auto number = [](auto count) { return static_cast<double>(count); };
  return {{"robot_cycles", number(robots.cycles)},
          {"robot_interruptions", number(robots.interruptions)},
          {"rsi_restarts", number(robots.rsi_restarts)},
          {"rsi_delay_max", number(robots.delay_max)},
          {"rsi_states_skipped", number(robots.skipped_states)},
          {"rsi_datagrams_unreadable", number(robots.unreadable_datagrams)},
          {"rsi_datagrams_foreign", number(robots.foreign_datagrams)},
          {"capture_frames", number(capture.frames)},
          {"capture_frames_lost", number(capture.frames_lost)},
          {"capture_objects_missing", number(capture.missing)},
          {"capture_objects_occluded", number(capture.occluded)},
          {"capture_objects_frozen", number(capture.frozen)},
          {"camera_frames", number(parts_->frames)},
          {"camera_images_stale", parts_->camera ? number(parts_->camera->stale_images()) : 0.0},
          {"camera_retries", number(parts_->retries)}};
}

}  // namespace vbar::tron
