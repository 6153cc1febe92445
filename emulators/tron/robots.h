#pragma once
// Both emulated robots: their controllers, and where their axes really are.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <nlohmann/json_fwd.hpp>

#include "emulators/tron/controller/controller.h"
#include "emulators/tron/settings.h"
#include "emulators/tron/world/world.h"
#include "hil_drivers/tron/geometry/kinematics.h"

namespace vbar::tron::bench {

/// Holds the ports of the driver; 0: as the laboratory file states.
struct DriverPorts {
  std::uint16_t camera_rsi = 0, target_rsi = 0, vicon = 0;
};

class Robots {
 public:
  /// Throws std::runtime_error, mission::MissionError.
  Robots(boost::asio::io_context& context, const BenchSettings& settings, const World& world, const DriverPorts& ports);

  /// Returns the posture where the axes really are.
  [[nodiscard]] Posture true_posture() const;
  /// Returns the posture as the motors measure it.
  [[nodiscard]] Posture measured_posture() const;

  [[nodiscard]] const Controller& of_camera() const { return *camera_; }
  [[nodiscard]] const Controller& of_target() const { return *target_; }
  [[nodiscard]] std::vector<Controller*> both() { return {camera_.get(), target_.get()}; }

  /// Returns false for a fault that is not one of a robot.
  bool set_fault(const Fault& fault, bool is_on);

  /// Returns the counters of each robot.
  [[nodiscard]] nlohmann::ordered_json summary() const;

 private:
  double track_home_m_;
  std::unique_ptr<Controller> camera_, target_;
  std::uint64_t camera_standstills_ = 0, target_standstills_ = 0;
};

}  // namespace vbar::tron::bench
