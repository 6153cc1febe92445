#pragma once
// Testbed under calibration, over its wires.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "hil_drivers/common/emulator_process.h"
#include "hil_drivers/tron/calibration/procedure.h"
#include "hil_drivers/tron/laboratory.h"
#include "hil_drivers/tron/motion_planning/arm_planner.h"

namespace vbar::tron::calibrate {

struct WiredBenchSettings {
  TestbedDesign bench;
  std::string bench_command;  ///< command line of an emulator; empty: the laboratory of the bench file
  std::uint64_t seed = 1;
  std::filesystem::path data_directory;
  twins::camera::Region region{160, 100, 1600, 1000};
  int bits = 12;
  std::function<void(const std::string&)> report;  ///< sentences for the operator
};

class WiredTestbed final : public CalibrationTestbed {
 public:
  /// Starts an emulator and opens all devices. Throws std::runtime_error.
  explicit WiredTestbed(const WiredBenchSettings& settings);

  [[nodiscard]] TestbedIdentity identity() override;
  void mount(Mounted what) override;
  [[nodiscard]] bool move(const Posture& posture) override;
  [[nodiscard]] MeasuredPosture measure() override;
  void light(const LightShares& shares) override;
  [[nodiscard]] CalibrationImage take(double exposure_s) override;

  /// Returns the emulator's table of true poses, which exists until this object ends; empty for a real testbed.
  [[nodiscard]] std::filesystem::path truth() const;

 private:
  WiredBenchSettings settings_;
  WiredDevices laboratory_;
  std::optional<testbeds::EmulatorProcess> process_;
  std::filesystem::path control_;
  TestbedBodies bodies_;
  PathPlanner paths_;
  double lamp_azimuth_rad_;
};

}  // namespace vbar::tron::calibrate
