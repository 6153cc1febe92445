#pragma once
// Emulated camera on the network: a GigE Vision device on a loopback address of its own. With the virtual clock it
// exposes on the thread of the emulator, between two robot cycles; with the real one on a thread of its own, so that
// the robots do not wait for an image.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>

#include "emulators/gige/device.h"
#include "emulators/tron/faults.h"
#include "emulators/tron/scene/lab_view.h"
#include "emulators/tron/settings.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

/// Holds the steps of an exposure.
struct ExposureSteps {
  std::function<LabView(const gige::Request& request)> look;              ///< on the emulator's thread
  std::function<std::vector<std::uint16_t>(const LabView& view)> render;  ///< on the camera's
  std::function<void()> done;                                             ///< on the emulator's thread
};

class CameraLink {
 public:
  /// Takes the first address from 127.0.21.1 that has no camera. Throws std::runtime_error if there is none.
  CameraLink(boost::asio::io_context& context, const BenchSettings& settings,
             const twins::camera::CameraSettings& camera, ExposureSteps steps);
  ~CameraLink();
  CameraLink(const CameraLink&) = delete;
  CameraLink& operator=(const CameraLink&) = delete;

  [[nodiscard]] const std::string& address() const { return address_; }
  /// Returns the statistics at the beginning of the last exposure.
  [[nodiscard]] gige::Device::Statistics statistics() const;
  /// Returns false for a fault that is not one of the link.
  bool set_fault(const Fault& fault, bool is_on);

 private:
  using WorkGuard = boost::asio::executor_work_guard<boost::asio::io_context::executor_type>;
  gige::Image expose(const gige::Request& request);
  /// Renders on another thread, while this one goes on with `context`.
  gige::Image render(const LabView& view, boost::asio::io_context& context);
  void apply(gige::Device& device, const Fault& fault, bool is_on);

  boost::asio::io_context& context_;
  ExposureSteps steps_;
  std::unique_ptr<boost::asio::io_context> own_context_;  ///< with the real clock
  std::optional<WorkGuard> guard_;
  std::string address_;
  std::unique_ptr<gige::Device> device_;
  gige::PacketFaults packet_faults_;
  mutable std::mutex mutex_;
  gige::Device::Statistics statistics_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace vbar::tron::bench
