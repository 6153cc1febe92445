#pragma once
// Emulated testbed as it really is: the poses of camera and target at a posture of the axes, and the true lens.
// The hidden errors are functions of the seed alone.

#include <array>
#include <cstdint>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench/world/error_sizes.h"
#include "hil_drivers/tron/bench/world/true_arm.h"
#include "hil_drivers/tron/bench/world/true_track.h"
#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

/// Names what hangs on the plate of the target's arm.
enum class Mounted { kTarget, kBoard, kPatch };
inline constexpr std::size_t kMountedThings = 3;

class World {
 public:
  /// Draws the hidden errors. `T_flange_mounted`: as designed, in the order of Mounted.
  World(const BenchFile& laboratory, const std::array<Eigen::Isometry3d, kMountedThings>& T_flange_mounted,
        const ErrorSizes& sizes, std::uint64_t seed);

  // Returns the deviation of the axes from their encoders at the standstill of a robot with this number.
  [[nodiscard]] Joints camera_arm_deviation_rad(std::uint64_t standstill) const {
    return camera_arm_.repeatability_rad(standstill);
  }
  [[nodiscard]] double carriage_deviation_m(std::uint64_t standstill) const {
    return track_.repeatability_m(standstill);
  }
  [[nodiscard]] Joints target_arm_deviation_rad(std::uint64_t standstill) const {
    return target_arm_.repeatability_rad(standstill);
  }

  // Return poses by the places of the axes: encoders and these deviations.
  [[nodiscard]] Eigen::Isometry3d T_L_camera_base(const Posture& posture) const;
  [[nodiscard]] const Eigen::Isometry3d& T_L_target_base() const { return T_L_target_base_; }
  [[nodiscard]] Eigen::Isometry3d T_L_C(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d T_L_mounted(const Posture& posture, Mounted mounted) const;
  [[nodiscard]] Eigen::Isometry3d T_C_mounted(const Posture& posture, Mounted mounted) const;

  /// Slips what hangs on the plate along its x.
  void slip(double x_m);

 private:
  TrueArm camera_arm_, target_arm_;
  TrueTrack track_;
  Eigen::Isometry3d T_L_target_base_;
  Eigen::Isometry3d T_flange_camera_;
  std::array<Eigen::Isometry3d, kMountedThings> T_flange_mounted_;
};

/// Returns the lens as it really is.
[[nodiscard]] twins::camera::CameraSettings with_lens_errors(const twins::camera::CameraSettings& design,
                                                             const ErrorSizes& sizes, std::uint64_t seed);

}  // namespace vbar::tron::bench
