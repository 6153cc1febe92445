#include "hil_drivers/optical_stimulator/hardware/devices.h"

#include <array>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/zaber/client.h"

namespace vbar::optical_stimulator {

TestbedAddresses read_addresses(const std::filesystem::path& file) {
  try {
    std::ifstream stream(file);
    const nlohmann::json json = nlohmann::json::parse(stream);
    TestbedAddresses addresses;
    addresses.display = json.at("display").get<std::string>();
    addresses.camera = json.at("camera").get<std::string>();
    addresses.rails = json.at("rails").at("pty").get<std::string>();
    return addresses;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": not the addresses of a bench: " + error.what());
  }
}

namespace {

class DisplayScreen final : public Screen {
 public:
  explicit DisplayScreen(const DisplaySettings& settings) : display_(settings) {}
  void show(const Picture& picture) override { display_.show(picture); }

 private:
  Display display_;
};

class GigeFrameCamera final : public FrameCamera {
 public:
  GigeFrameCamera(const gige::Camera::Settings& settings, int tries) : camera_(settings), tries_(tries) {
    camera_.open();
  }

  CameraFrame take() override {
    gige::NoFrame last;
    const std::int64_t stale_before = camera_.stale_images();
    for (int k = 1; k <= tries_; ++k) {
      auto result = camera_.take();
      if (auto* const frame = std::get_if<gige::Frame>(&result))
        return {std::move(frame->dn), static_cast<int>(frame->packets_resent), k, frame->receive_s,
                static_cast<int>(camera_.stale_images() - stale_before)};
      last = std::get<gige::NoFrame>(result);
      using enum gige::NoFrame::Reason;
      // Another trigger helps against lost packets and late images only.
      if (last.reason != kTimeout && last.reason != kIncomplete && last.reason != kInvalid && last.reason != kStale)
        break;
    }
    throw std::runtime_error(last.text);
  }
  void reopen() override { camera_.reconnect(); }
  void stop() noexcept { camera_.stop(); }

  [[nodiscard]] const gige::Camera& camera() const { return camera_; }

 private:
  gige::Camera camera_;
  int tries_;
};

gige::Camera::Settings camera_settings(const DevicePlan& plan, const StimulatorCalibration& calibration) {
  gige::Camera::Settings settings;
  settings.address = plan.camera_address;
  settings.model = calibration.validity.camera_model;
  settings.serial = calibration.validity.camera_serial;
  settings.exposure_s = plan.exposure_s;
  settings.region = plan.region;
  settings.converter_bits = calibration.camera.bits;
  settings.packet_size = plan.packet_size;
  if (plan.packet_delay_us) settings.packet_delay_us = *plan.packet_delay_us;
  settings.timeout_s = std::chrono::duration<double>(plan.timeout).count();
  return settings;
}

/// Axis 1 carries lens 2, axis 2 the display.
class Rails {
 public:
  Rails(const std::string& line, const Validity& validity)
      : client_(settings_of(line)), places_um_{1e3 * validity.rail_lens_mm, 1e3 * validity.rail_display_mm} {
    for (int axis = 1; axis <= kAxes; ++axis) client_.home_if_needed(axis);
    for (int axis = 1; axis <= kAxes; ++axis) client_.move_to_um(axis, places_um_[static_cast<std::size_t>(axis - 1)]);
  }

  RailPositions check() {
    for (int axis = 1; axis <= kAxes; ++axis)
      client_.check_held_at_um(axis, places_um_[static_cast<std::size_t>(axis - 1)]);
    return {1e-3 * client_.position_um(1), 1e-3 * client_.position_um(2)};
  }

 private:
  static constexpr int kAxes = 2;

  static zaber::ClientSettings settings_of(const std::string& line) {
    zaber::ClientSettings settings;
    settings.line = line;
    return settings;
  }

  zaber::Client client_;
  std::array<double, kAxes> places_um_;
};

}  // namespace

struct StimulatorDevices::Parts {
  Parts(const DevicePlan& plan, const StimulatorCalibration& calibration)
      : screen(plan.display), camera(camera_settings(plan, calibration), 1 + plan.retries) {
    if (!plan.rails.empty()) rails.emplace(plan.rails, calibration.validity);
  }

  DisplayScreen screen;
  GigeFrameCamera camera;
  std::optional<Rails> rails;
  CameraIdentity identity;
};

StimulatorDevices::StimulatorDevices(const DevicePlan& plan, const StimulatorCalibration& calibration)
    : parts_(std::make_unique<Parts>(plan, calibration)) {
  const gige::Camera::Identity& camera = parts_->camera.camera().identity();
  parts_->identity = {camera.vendor, camera.model, camera.serial, camera.is_emulated()};
}

StimulatorDevices::~StimulatorDevices() = default;

Screen& StimulatorDevices::screen() {
  return parts_->screen;
}
FrameCamera& StimulatorDevices::camera() {
  return parts_->camera;
}
const CameraIdentity& StimulatorDevices::identity() const {
  return parts_->identity;
}
std::optional<RailPositions> StimulatorDevices::check_rails() {
  if (!parts_->rails) return std::nullopt;
  return parts_->rails->check();
}
void StimulatorDevices::stop() noexcept {
  parts_->camera.stop();
}

}  // namespace vbar::optical_stimulator
