#pragma once
// Emulated testbed: X server, optics, camera, rails and faults in one directory and one event loop.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "emulators/common/control_line.h"
#include "emulators/common/emulator_program.h"
#include "emulators/optical_stimulator/camera_link.h"
#include "emulators/optical_stimulator/fault_list.h"
#include "emulators/optical_stimulator/optical_path.h"
#include "emulators/optical_stimulator/screen.h"
#include "emulators/optical_stimulator/settings.h"
#include "emulators/zaber/device.h"

namespace vbar::optical_stimulator::bench {

class Bench {
 public:
  /// Makes everything and, when it listens, writes DIR/addresses.json. To be made by the thread that runs `context`.
  /// Throws std::runtime_error, mission::MissionError; each one sentence.
  Bench(boost::asio::io_context& context, const BenchSettings& settings, const std::filesystem::path& data_directory,
        const std::filesystem::path& directory, std::function<void()> exit);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

 private:
  /// Exposes what is on the screen.
  std::vector<std::uint16_t> expose(const ExposureRequest& request);
  [[nodiscard]] double now_s() const;
  [[nodiscard]] RailPlaces rail_places();
  [[nodiscard]] FaultActions fault_actions(std::function<void()> exit);
  void look_around();
  void write_addresses() const;

  BenchSettings settings_;
  emulators::EmulatorDirectory directory_;
  OpticalPath path_;
  VirtualScreen screen_;
  ScreenWatch watch_;
  Panel panel_;
  zaber::Device rails_;
  double lens_zero_mm_, display_zero_mm_;
  zaber::DeviceServer rail_server_;
  std::unique_ptr<CameraLink> camera_;
  FaultList faults_;
  emulators::ControlLine control_;
  boost::asio::steady_timer timer_;
  std::uint64_t frames_ = 0;  ///< delivered so far
};

}  // namespace vbar::optical_stimulator::bench
