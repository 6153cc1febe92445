#pragma once
// A bench of numbers: hidden errors of a seed, with the standard deviations of the design brief (section 6), and what
// its instruments would measure. Its chain is written out here once more, link by link, and has errors that the fit's
// model lacks: gears, sines of the track, a field of bias of motion capture.

#include <array>
#include <cstdint>
#include <vector>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::calibrate {

class SimulatedBench {
 public:
  SimulatedBench(const TestbedDesign& bench, const LensCalibration& lens, std::uint64_t seed);

  /// Moves, and measures: joints as the controllers state them, corners, motion capture.
  [[nodiscard]] Measurement measure(const Posture& commanded);

  [[nodiscard]] const LensCalibration& true_lens() const { return lens_; }
  [[nodiscard]] Eigen::Isometry3d T_L_C(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d T_L_T(const Posture& posture) const;

  double corner_sigma_px = 0.35, bad_share = 0.08, bad_factor = 6.0;

 private:
  struct Arm {
    ArmLengths lengths;
    Joints offset_rad;
    std::array<Eigen::Isometry3d, 5> link;
    Joints gear_rad, gear_phase;
    std::array<double, 6> gear_periods;
    std::array<double, 2> flex_rad_m;
    double gravity = 1.0;
    Eigen::Isometry3d mount;
  };
  struct Wave {
    double amplitude, wavelength_m, phase;
    [[nodiscard]] double at(double x_m) const;
  };

  Arm draw_arm(const ArmDesign& design, double gravity, const Eigen::Isometry3d& mount);
  Eigen::Isometry3d draw_pose(double rotation_rad, double place_m);
  [[nodiscard]] static Eigen::Isometry3d flange(const Arm& arm, const Joints& joints);
  [[nodiscard]] Eigen::Isometry3d by_vicon(const Eigen::Isometry3d& T_V_object);

  TestbedDesign bench_;
  engine::RandomStream random_;
  LensCalibration lens_;
  BoardDesign board_;
  Arm camera_, target_;
  Eigen::Isometry3d target_base_, V_L_, C_object_, object_T_, T_T_B_;
  double track_scale_ = 0.0;
  std::array<std::array<Wave, 2>, 5> track_;  ///< roll, pitch, yaw, sideways, height
  std::array<std::array<Wave, 9>, 3> vicon_field_;
};

}  // namespace vbar::tron::calibrate
