#include "hil_drivers/optical_stimulator/program/wired_testbed.h"

#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "hil_drivers/gige/camera/camera.h"
#include "hil_drivers/zaber/client.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

constexpr int kLensAxis = 1, kDisplayAxis = 2;

class WiredScreen final : public Screen {
 public:
  WiredScreen(const DisplaySettings& settings, std::chrono::milliseconds settle)
      : settings_(settings), settle_(settle), display_(settings) {}

  [[nodiscard]] int width() const override { return settings_.width; }
  [[nodiscard]] int height() const override { return settings_.height; }
  void show(const Picture& counts) override {
    display_.show(counts);
    std::this_thread::sleep_for(settle_);
  }

 private:
  DisplaySettings settings_;
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

}  // namespace

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

}  // namespace vbar::optical_stimulator::calibrate
