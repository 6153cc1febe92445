#pragma once
// Arm as it really is: offsets and gear errors of its joints, errors of its links, its bending under gravity. Its
// forward kinematics shares no code with the driver's.

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench/world/error_sizes.h"
#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron::bench {

class TrueArm {
 public:
  /// Draws the errors. `up`: +1 for an arm that stands, -1 for one that hangs. `name` names the random streams.
  TrueArm(const ArmDesign& design, double up, const ErrorSizes& sizes, std::uint64_t seed, const std::string& name);

  /// Returns the pose at the joints that the encoders state.
  [[nodiscard]] Eigen::Isometry3d T_base_flange(const Joints& encoder_rad) const;

  /// Returns the deviation of the joints from their encoders at standstill number `number`.
  [[nodiscard]] Joints repeatability_rad(std::uint64_t number) const;

 private:
  struct Joint {
    fsw::Vector3 before_m = fsw::Vector3::Zero();  ///< from the axis before it, along the link's axes at zero angles
    fsw::Vector3 axis = fsw::Vector3::UnitZ();
    double offset_rad = 0.0;
    double gear_rad = 0.0, gear_phase_rad = 0.0;
    int gear_periods = 1;
    double flex_rad_m = 0.0;
    Eigen::Isometry3d error_after = Eigen::Isometry3d::Identity();
  };
  [[nodiscard]] Joints true_angles(const Joints& encoder_rad) const;
  /// Returns the horizontal distance, in the arm's plane, of the wrist from the axis of A2 and of A3, m.
  [[nodiscard]] std::array<double, 2> levers_m(const Joints& angles_rad) const;

  std::array<Joint, kJoints> joints_;
  double flange_m_;
  double up_;
  double repeatability_rad_;
  std::uint64_t seed_;
  std::string name_;
};

}  // namespace vbar::tron::bench
