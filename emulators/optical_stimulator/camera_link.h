#pragma once
// Emulated camera on the network: a GigE Vision device on a loopback address of its own.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "emulators/gige/device.h"
#include "emulators/optical_stimulator/faults.h"
#include "emulators/optical_stimulator/optical_path.h"
#include "emulators/optical_stimulator/settings.h"

namespace vbar::optical_stimulator::bench {

class CameraLink {
 public:
  using Expose = std::function<std::vector<std::uint16_t>(const ExposureRequest& request)>;

  /// Takes the first address from 127.0.13.1 that has no camera. Throws std::runtime_error if there is none.
  CameraLink(boost::asio::io_context& context, const BenchSettings& settings,
             const twins::camera::CameraSettings& camera, Expose expose);

  [[nodiscard]] const std::string& address() const { return address_; }
  void set_fault(const Fault& fault, bool is_on);

 private:
  std::string address_;
  std::unique_ptr<gige::Device> device_;
  gige::PacketFaults packet_faults_;
};

}  // namespace vbar::optical_stimulator::bench
