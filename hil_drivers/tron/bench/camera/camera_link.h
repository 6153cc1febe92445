#pragma once
// The emulated camera on the network: a GigE Vision device on a loopback address of its own.

#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/gige/device/device.h"
#include "hil_drivers/tron/bench/bench_settings.h"
#include "hil_drivers/tron/bench/faults/bench_fault.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

class CameraLink {
 public:
  /// On the first address from 127.0.21.1 that has no camera. Throws std::runtime_error if there is none.
  CameraLink(boost::asio::io_context& context, const BenchSettings& settings,
             const twins::camera::CameraSettings& camera, const gige::Expose& expose);

  [[nodiscard]] const std::string& address() const { return address_; }
  [[nodiscard]] gige::Device::Statistics statistics() const { return device_->statistics(); }
  /// False for a fault that is not one of the link.
  bool set_fault(const Fault& fault, bool is_on);

 private:
  std::string address_;
  std::unique_ptr<gige::Device> device_;
  gige::PacketFaults packet_faults_;
};

}  // namespace vbar::tron::bench
