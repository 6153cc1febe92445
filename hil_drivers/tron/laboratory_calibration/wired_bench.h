#pragma once
// Testbed under calibration, over its wires.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "hil_drivers/bench_process/bench_process.h"
#include "hil_drivers/tron/calibrate/procedure/calibration_bench.h"
#include "hil_drivers/tron/hardware/wired_laboratory.h"
#include "hil_drivers/tron/planner/arm_planner.h"

namespace vbar::tron::calibrate {

struct WiredBenchSettings {
  BenchFile bench;
  std::string bench_command;  ///< command line of an emulator; empty: the laboratory of the bench file
  std::uint64_t seed = 1;
  std::filesystem::path data_directory;
  twins::camera::Region region{160, 100, 1600, 1000};
  int bits = 12;
  std::function<void(const std::string&)> report;  ///< sentences for the operator
};

class WiredBench final : public CalibrationBench {
 public:
  /// Starts an emulator and opens all devices. Throws std::runtime_error.
  explicit WiredBench(const WiredBenchSettings& settings);

  [[nodiscard]] BenchIdentity identity() override;
  void mount(Mounted what) override;
  [[nodiscard]] bool move(const Posture& posture) override;
  [[nodiscard]] BenchPlace measure() override;
  void light(const LightShares& shares) override;
  [[nodiscard]] BenchImage take(double exposure_s) override;

  /// Returns the emulator's table of true poses, which exists until this object ends; empty for a real testbed.
  [[nodiscard]] std::filesystem::path truth() const;

 private:
  WiredBenchSettings settings_;
  WiredLaboratory laboratory_;
  std::optional<bench_process::BenchProcess> process_;
  std::filesystem::path control_;
  BenchBodies bodies_;
  PathPlanner paths_;
  double lamp_azimuth_rad_;
};

}  // namespace vbar::tron::calibrate
