#pragma once
// Emulated testbed: robots, motion capture, lights and camera on one clock, in one directory and one event
// loop.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <nlohmann/json_fwd.hpp>

#include "emulators/common/control_line.h"
#include "emulators/common/emulator_program.h"
#include "emulators/tron/camera_link.h"
#include "emulators/tron/controller/cycle_clock.h"
#include "emulators/tron/faults.h"
#include "emulators/tron/lights.h"
#include "emulators/tron/robots.h"
#include "emulators/tron/scene/lab_renderer.h"
#include "emulators/tron/settings.h"
#include "emulators/tron/truth.h"
#include "emulators/tron/world/motion_capture.h"
#include "emulators/tron/world/world.h"

namespace vbar::tron::bench {

/// States where the emulator is made and whom it serves.
struct MeasuredPosture {
  std::filesystem::path data;       ///< folder of the project's data
  std::filesystem::path directory;  ///< for sockets, addresses.json, faults.jsonl, truth.csv, summary.json
  std::filesystem::path truth;      ///< path of truth.csv; empty: in `directory`
  DriverPorts ports;
};

class Bench {
 public:
  /// Makes everything and, when it listens, writes DIR/addresses.json. To be made by the thread that runs `context`.
  /// Throws std::runtime_error, mission::MissionError; each one sentence.
  Bench(boost::asio::io_context& context, const BenchSettings& settings, const MeasuredPosture& place,
        std::function<void()> exit);
  /// Writes DIR/summary.json.
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

 private:
  void begin_cycle(std::uint64_t cycle);
  void end_motion();
  /// Returns the view of an exposure that begins now; it is written to the log of truth.
  LabView look(const gige::Request& request);
  /// Renders on the camera's thread.
  std::vector<std::uint16_t> render(const LabView& view);
  void end_exposure();
  /// Returns false for a fault that is not one of motion capture or lights.
  bool set_light_or_capture(const Fault& fault, bool is_on);
  void act(const Fault& fault, bool is_on);
  void control(const std::string& line, const emulators::Answer& answer);
  [[nodiscard]] nlohmann::ordered_json summary() const;
  [[nodiscard]] double wall_s() const;
  void look_around();
  void write_addresses() const;

  BenchSettings settings_;
  std::uint16_t vicon_port_;  ///< port of the driver
  emulators::EmulatorDirectory directory_;
  World world_;
  Robots robots_;
  CaptureErrors capture_errors_;
  CaptureView capture_view_;
  ObjectStreamSender vicon_;
  LightRig rig_;
  LightReceiver lights_;
  CycleClock clock_;
  twins::camera::CameraSettings sensor_;
  double exposure_factor_ = 1.0, gain_factor_ = 1.0;  ///< faults
  LabRenderer renderer_;
  std::atomic<std::uint64_t> views_refused_ = 0;
  TruthLog truth_;
  std::function<void()> exit_;
  FaultList faults_;
  CameraLink camera_;
  emulators::ControlLine control_;
  boost::asio::steady_timer timer_;
  Mounted mounted_ = Mounted::kTarget;
  std::uint64_t images_ = 0;  ///< exposed so far
};

}  // namespace vbar::tron::bench
