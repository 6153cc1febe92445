#include "hil_drivers/tron/bench/camera/camera_link.h"

#include <utility>

#include "hil_drivers/gige/device/free_address.h"

namespace vbar::tron::bench {
namespace {

constexpr const char* kNetwork = "127.0.21";

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
  device.pace = settings.clock.kind == ClockKind::kReal ? gige::Pace::kReal : gige::Pace::kFast;
  device.seed = settings.seed;
  return device;
}

}  // namespace

CameraLink::CameraLink(boost::asio::io_context& context, const BenchSettings& settings,
                       const twins::camera::CameraSettings& camera, const gige::Expose& expose) {
  auto placed = gige::device_on_free_address(context, device_settings(settings, camera), kNetwork, expose);
  address_ = std::move(placed.address);
  device_ = std::move(placed.device);
}

bool CameraLink::set_fault(const Fault& fault, bool is_on) {
  const double value = is_on ? fault.value : 0.0;
  const auto count = static_cast<int>(fault.value);
  switch (fault.kind) {
    case FaultKind::kCameraAway:
      device_->set_away(is_on);
      return true;
    case FaultKind::kCameraBusy:
      device_->set_busy(is_on);
      return true;
    case FaultKind::kPacketLoss:
      packet_faults_.loss = value;
      device_->set_packet_faults(packet_faults_);
      return true;
    case FaultKind::kPacketsDoubled:
      packet_faults_.duplicate = value;
      device_->set_packet_faults(packet_faults_);
      return true;
    case FaultKind::kPacketsReordered:
      packet_faults_.reorder = value;
      device_->set_packet_faults(packet_faults_);
      return true;
    case FaultKind::kTriggersIgnored:
      device_->ignore_triggers(count);
      return true;
    case FaultKind::kFramesLost:
      device_->lose_frames(count);
      return true;
    case FaultKind::kFramesStale:
      device_->repeat_frames(count);
      return true;
    default:
      return false;
  }
}

}  // namespace vbar::tron::bench
