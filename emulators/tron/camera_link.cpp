#include "emulators/tron/camera_link.h"

#include <chrono>
#include <future>
#include <utility>

#include <boost/asio/post.hpp>

#include "emulators/gige/device.h"

namespace vbar::tron::bench {
namespace {

namespace asio = boost::asio;

constexpr const char* kNetwork = "127.0.21";
constexpr std::chrono::milliseconds kLookForEnd{20}, kKeepAlive{5};

bool is_real(const BenchSettings& settings) {
  return settings.clock.kind == ClockKind::kReal;
}

gige::Device::Settings device_settings(const BenchSettings& settings, const twins::camera::CameraSettings& camera) {
  const CameraIdentity& identity = settings.identity;
  gige::Device::Settings device;
  device.description.manufacturer = identity.vendor;
  device.description.model = identity.model;
  device.description.serial =
      identity.serial.empty() ? gige::drawn_serial(settings.seed, "bench/camera/serial") : identity.serial;
  device.description.sensor_width = camera.detector.width;
  device.description.sensor_height = camera.detector.height;
  device.description.converter_bits = camera.detector.bits;
  device.pace = is_real(settings) ? gige::Pace::kReal : gige::Pace::kFast;
  device.seed = settings.seed;
  return device;
}

bool is_of_link(FaultKind kind) {
  switch (kind) {
    case FaultKind::kCameraAway:
    case FaultKind::kCameraBusy:
    case FaultKind::kPacketLoss:
    case FaultKind::kPacketsDoubled:
    case FaultKind::kPacketsReordered:
    case FaultKind::kTriggersIgnored:
    case FaultKind::kFramesLost:
    case FaultKind::kFramesStale:
      return true;
    default:
      return false;
  }
}

}  // namespace

CameraLink::CameraLink(asio::io_context& context, const BenchSettings& settings,
                       const twins::camera::CameraSettings& camera, ExposureSteps steps)
    : context_(context), steps_(std::move(steps)) {
  if (is_real(settings)) {
    own_context_ = std::make_unique<asio::io_context>(1);
    guard_.emplace(own_context_->get_executor());
  }
  auto placed =
      gige::device_on_free_address(own_context_ ? *own_context_ : context, device_settings(settings, camera), kNetwork,
                                   [this](const gige::Request& request) { return expose(request); });
  address_ = std::move(placed.address);
  device_ = std::move(placed.device);
  if (own_context_) thread_ = std::thread([this] { own_context_->run(); });
}

CameraLink::~CameraLink() {
  if (!thread_.joinable()) return;
  ends_ = true;
  guard_.reset();
  own_context_->stop();
  thread_.join();
}

gige::Image CameraLink::expose(const gige::Request& request) {
  {
    const std::lock_guard lock(mutex_);
    statistics_ = device_->statistics();
  }
  if (!own_context_) {
    gige::Image image = render(steps_.look(request), context_);
    steps_.done();
    return image;
  }
  const auto looked = std::make_shared<std::promise<LabView>>();
  std::future<LabView> view = looked->get_future();
  asio::post(context_, [this, looked, request] { looked->set_value(steps_.look(request)); });
  while (view.wait_for(kLookForEnd) != std::future_status::ready)
    if (ends_) return {};
  gige::Image image = render(view.get(), *own_context_);
  asio::post(context_, [this] { steps_.done(); });
  return image;
}

gige::Image CameraLink::render(const LabView& view, asio::io_context& context) {
  auto rendered = std::async(std::launch::async, [&] { return steps_.render(view); });
  // A client hears from the camera meanwhile: its heartbeat would expire on a loaded machine.
  while (rendered.wait_for(kKeepAlive) != std::future_status::ready) context.poll();
  return {rendered.get()};
}

gige::Device::Statistics CameraLink::statistics() const {
  const std::lock_guard lock(mutex_);
  return statistics_;
}

bool CameraLink::set_fault(const Fault& fault, bool is_on) {
  if (!is_of_link(fault.kind)) return false;
  if (own_context_)
    asio::post(*own_context_, [this, fault, is_on] { apply(*device_, fault, is_on); });
  else
    apply(*device_, fault, is_on);
  return true;
}

void CameraLink::apply(gige::Device& device, const Fault& fault, bool is_on) {
  const double value = is_on ? fault.value : 0.0;
  const auto count = static_cast<int>(fault.value);
  switch (fault.kind) {
    case FaultKind::kCameraAway:
      return device.set_away(is_on);
    case FaultKind::kCameraBusy:
      return device.set_busy(is_on);
    case FaultKind::kPacketLoss:
      packet_faults_.loss = value;
      return device.set_packet_faults(packet_faults_);
    case FaultKind::kPacketsDoubled:
      packet_faults_.duplicate = value;
      return device.set_packet_faults(packet_faults_);
    case FaultKind::kPacketsReordered:
      packet_faults_.reorder = value;
      return device.set_packet_faults(packet_faults_);
    case FaultKind::kTriggersIgnored:
      return device.ignore_triggers(count);
    case FaultKind::kFramesLost:
      return device.lose_frames(count);
    case FaultKind::kFramesStale:
      return device.repeat_frames(count);
    default:
      return;
  }
}

}  // namespace vbar::tron::bench
