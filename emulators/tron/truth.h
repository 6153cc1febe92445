#pragma once
// Truth at each exposure: a table for the evaluation, which the driver does not read.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "emulators/tron/world/motion_capture.h"
#include "emulators/tron/world/vicon_visibility.h"
#include "emulators/tron/world/world.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron::bench {

// Objects that motion capture can track at a posture: markers on camera and mock-up, hidden by arms and bodies.

class CaptureView {
 public:
  CaptureView(const TestbedDesign& laboratory, const World& world);

  /// Returns the number of markers located, of camera and target.
  [[nodiscard]] std::array<std::size_t, kCaptureObjects> located(const Posture& posture) const;
  /// Returns the links of both arms, where they really are.
  [[nodiscard]] std::vector<Capsule> arms(const Posture& posture) const;
  /// Returns the true pose of the camera, or of the plate's mock-up whatever hangs there; nothing if it is not tracked.
  [[nodiscard]] std::optional<Eigen::Isometry3d> tracked(CaptureObject object, const Posture& posture) const;

 private:
  struct Object {
    std::vector<Marker> markers;
    fsw::Vector3 low_m, high_m;  ///< box of the body that hides
  };
  [[nodiscard]] Eigen::Isometry3d T_L_body(CaptureObject object, const Posture& posture) const;
  [[nodiscard]] std::size_t located(CaptureObject object, const Posture& posture) const;

  const TestbedDesign& laboratory_;
  const World& world_;
  ViconVisibility cameras_;
  std::array<Object, kCaptureObjects> objects_;
};

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
