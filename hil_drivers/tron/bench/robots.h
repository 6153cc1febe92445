#pragma once
// Both emulated robots: their controllers, and where their axes really are.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <nlohmann/json_fwd.hpp>

#include "hil_drivers/tron/bench/bench_settings.h"
#include "hil_drivers/tron/bench/controller/controller.h"
#include "hil_drivers/tron/bench/world/world.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron::bench {

/// Ports of the driver; 0: as the laboratory file says.
struct DriverPorts {
  std::uint16_t camera_rsi = 0, target_rsi = 0, vicon = 0;
};

class Robots {
 public:
  /// `files`: folder of the Ethernet configurations and contexts. Throws std::runtime_error, mission::MissionError.
  Robots(boost::asio::io_context& context, const BenchSettings& settings, const World& world,
         const std::filesystem::path& files, const DriverPorts& ports);

  /// Where the axes really are.
  [[nodiscard]] Posture true_posture() const;
  /// As the motors measure it.
  [[nodiscard]] Posture measured_posture() const;

  [[nodiscard]] Controller& of_camera() { return *camera_; }
  [[nodiscard]] Controller& of_target() { return *target_; }
  [[nodiscard]] std::vector<Controller*> both() { return {camera_.get(), target_.get()}; }

  /// What each has counted.
  [[nodiscard]] nlohmann::ordered_json summary() const;

 private:
  double track_home_m_;
  std::unique_ptr<Controller> camera_, target_;
  std::uint64_t camera_standstills_ = 0, target_standstills_ = 0;
};

}  // namespace vbar::tron::bench
