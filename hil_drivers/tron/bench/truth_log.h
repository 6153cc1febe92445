#pragma once
// Truth at each exposure: a table for the evaluation, which the driver does not read.

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench/world/world.h"
#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron::bench {

struct TrueExposure {
  std::uint64_t image = 0;  ///< number of the exposure, from 0
  std::uint64_t cycle = 0;
  double bench_s = 0.0;
  double exposure_s = 0.0;
  Mounted mounted = Mounted::kTarget;
  Eigen::Isometry3d T_C_mounted = Eigen::Isometry3d::Identity();
  Posture posture;
  double lamp_power = 0.0, lamp_azimuth_rad = 0.0;  ///< power: of light, 0 to 1
  std::array<double, kBoxes> box_power{};
  std::size_t markers_of_camera = 0, markers_of_target = 0;  ///< located by motion capture
};

class TruthLog {
 public:
  /// Throws std::runtime_error if the file cannot be made.
  explicit TruthLog(const std::filesystem::path& file);
  /// Writes at once, since the program may be killed.
  void write(const TrueExposure& exposure);

 private:
  std::ofstream file_;
};

}  // namespace vbar::tron::bench
