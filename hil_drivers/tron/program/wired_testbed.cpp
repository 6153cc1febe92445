#include "hil_drivers/tron/program/wired_testbed.h"

#include <chrono>
#include <cmath>
#include <iostream>
#include <span>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>

#include "host_sim/io/byte_channel.h"

namespace vbar::tron::calibrate {
namespace {

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

}  // namespace

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

}  // namespace vbar::tron::calibrate
