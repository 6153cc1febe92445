#include "emulators/optical_stimulator/camera_link.h"

#include <chrono>
#include <utility>

#include "emulators/gige/device.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr const char* kNetwork = "127.0.13";

std::string serial_of(const BenchSettings& settings) {
  if (!settings.identity.serial.empty()) return settings.identity.serial;
  return gige::drawn_serial(settings.seed, "bench/camera/serial");
}

gige::Device::Settings device_settings(const BenchSettings& settings, const twins::camera::CameraSettings& camera) {
  gige::Device::Settings device;
  device.description.manufacturer = settings.identity.vendor;
  device.description.model = settings.identity.model;
  device.description.serial = serial_of(settings);
  device.description.sensor_width = camera.detector.width;
  device.description.sensor_height = camera.detector.height;
  device.description.converter_bits = camera.detector.bits;
  device.pace = settings.pace == Pace::kReal ? gige::Pace::kReal : gige::Pace::kFast;
  device.seed = settings.seed;
  return device;
}

}  // namespace

CameraLink::CameraLink(boost::asio::io_context& context, const BenchSettings& settings,
                       const twins::camera::CameraSettings& camera, Expose expose) {
  const gige::Expose on_trigger = [expose = std::move(expose)](const gige::Request& request) {
    return gige::Image{expose({request.region, {request.exposure_s, request.gain_db, request.black_level_dn}})};
  };
  auto placed = gige::device_on_free_address(context, device_settings(settings, camera), kNetwork, on_trigger);
  address_ = placed.address;
  device_ = std::move(placed.device);
}

void CameraLink::set_fault(const Fault& fault, bool is_on) {
  const double value = is_on ? fault.value : 0.0;
  switch (fault.kind) {
    case FaultKind::kCameraAway:
      return device_->set_away(is_on);
    case FaultKind::kCameraBusy:
      return device_->set_busy(is_on);
    case FaultKind::kPacketLoss:
      packet_faults_.loss = value;
      return device_->set_packet_faults(packet_faults_);
    case FaultKind::kPacketsDoubled:
      packet_faults_.duplicate = value;
      return device_->set_packet_faults(packet_faults_);
    case FaultKind::kPacketsReordered:
      packet_faults_.reorder = value;
      return device_->set_packet_faults(packet_faults_);
    case FaultKind::kAnswersLate:
      return device_->set_answer_delay(std::chrono::milliseconds(static_cast<int>(value)));
    case FaultKind::kXmlDamaged:
      return device_->damage_xml(is_on);
    case FaultKind::kRegionRefused:
      return device_->refuse_region(is_on);
    case FaultKind::kTriggersIgnored:
      return device_->ignore_triggers(static_cast<int>(value));
    case FaultKind::kLateFrame:
    case FaultKind::kFrozenDisplay:
    case FaultKind::kCoveredDisplay:
    case FaultKind::kMirroredDisplay:
    case FaultKind::kRotatedDisplay:
    case FaultKind::kExposure:
    case FaultKind::kGain:
    case FaultKind::kBrightness:
    case FaultKind::kBumped:
    case FaultKind::kRailStalled:
    case FaultKind::kRailMoved:
    case FaultKind::kBenchExit:
      return;
  }
}

}  // namespace vbar::optical_stimulator::bench
