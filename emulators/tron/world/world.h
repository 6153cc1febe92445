#pragma once
// Emulated testbed as it really is: the poses of camera and target at a posture of the axes, and the true lens.
// The hidden errors are functions of the seed alone.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

// Errors drawn from named random streams: poses and waves.

/// Returns a small pose: rotation vector and translation, each component normal. The same stream with other sizes gives
/// the same error, scaled.
[[nodiscard]] Eigen::Isometry3d drawn_pose(std::uint64_t seed, const std::string& stream, double rotation_deg,
                                           double translation_mm);

/// Describes a random function of place of zero mean: two sinusoids of random wavelength.
class Wave {
 public:
  /// Draws the function. `sigma`: standard deviation at any place, over emulators.
  Wave(std::uint64_t seed, const std::string& stream, double sigma, double wavelength_low, double wavelength_high);
  [[nodiscard]] double at(double place) const;

 private:
  struct Part {
    double wavenumber = 0.0, sine = 0.0, cosine = 0.0;
  };
  std::array<Part, 2> parts_;
};

// Differences between an emulator and the laboratory as designed: one standard deviation of each hidden error. Each
// error is drawn once from the seed, in a random stream of its own name. Neither driver nor calibration reads any of
// them.

/// Holds the sizes; defaults are those of data/benches/tron_emulated.toml.
struct ErrorSizes {
  // Arms.
  double joint_offset_deg = 0.15;
  double link_rotation_deg = 0.03;    ///< after each joint, about each axis
  double link_translation_mm = 0.3;   ///< ... along each axis
  double gear_deg = 0.006;            ///< amplitude of a wave with 1 to 3 periods a turn
  double flex_deg_m = 0.05;           ///< flex of A2 a metre of horizontal lever: mean over benches, not a deviation
  double flex_ratio_a3 = 1.5;         ///< flex of A3 relative to that of A2
  double flex_spread = 0.2;           ///< relative standard deviation of both
  double repeatability_deg = 0.0015;  ///< error of each joint at each standstill
  // Track.
  double track_scale = 1e-4;
  double track_offset_mm = 0.8;       ///< sideways and in height
  double track_rotation_deg = 0.035;  ///< roll, pitch, yaw
  double track_repeatability_mm = 0.02;
  // Mounts.
  double mount_rotation_deg = 1.5;  ///< rotation of the camera, and of the plate that mock-up, board and patch share
  double mount_translation_mm = 4.0;
  double plate_rotation_deg = 0.01;  ///< rotation of each of these on the plate: dowel pins, places measured
  double plate_translation_mm = 0.05;
  double base_rotation_deg = 0.3;  ///< rotation of the arm on the floor
  double base_translation_mm = 5.0;
  // Lens.
  double focal_length = 0.003;  ///< relative
  double principal_point_px = 4.0;
  double distortion = 0.03;  ///< error of each coefficient, relative

  /// Returns sizes of a testbed exactly as designed.
  [[nodiscard]] static ErrorSizes none();
};

/// Describes a key of the table [errors].
struct ErrorKey {
  std::string_view key;
  double ErrorSizes::*size;
  double largest;
};

inline constexpr std::array<ErrorKey, 21> kErrorKeys{{
    {"joint_offset_deg", &ErrorSizes::joint_offset_deg, 5.0},
    {"link_rotation_deg", &ErrorSizes::link_rotation_deg, 5.0},
    {"link_translation_mm", &ErrorSizes::link_translation_mm, 50.0},
    {"gear_deg", &ErrorSizes::gear_deg, 1.0},
    {"flex_deg_m", &ErrorSizes::flex_deg_m, 5.0},
    {"flex_ratio_a3", &ErrorSizes::flex_ratio_a3, 10.0},
    {"flex_spread", &ErrorSizes::flex_spread, 1.0},
    {"repeatability_deg", &ErrorSizes::repeatability_deg, 1.0},
    {"track_scale", &ErrorSizes::track_scale, 0.1},
    {"track_offset_mm", &ErrorSizes::track_offset_mm, 50.0},
    {"track_rotation_deg", &ErrorSizes::track_rotation_deg, 5.0},
    {"track_repeatability_mm", &ErrorSizes::track_repeatability_mm, 10.0},
    {"mount_rotation_deg", &ErrorSizes::mount_rotation_deg, 20.0},
    {"mount_translation_mm", &ErrorSizes::mount_translation_mm, 100.0},
    {"plate_rotation_deg", &ErrorSizes::plate_rotation_deg, 20.0},
    {"plate_translation_mm", &ErrorSizes::plate_translation_mm, 100.0},
    {"base_rotation_deg", &ErrorSizes::base_rotation_deg, 20.0},
    {"base_translation_mm", &ErrorSizes::base_translation_mm, 200.0},
    {"focal_length", &ErrorSizes::focal_length, 0.1},
    {"principal_point_px", &ErrorSizes::principal_point_px, 200.0},
    {"distortion", &ErrorSizes::distortion, 1.0},
}};

inline ErrorSizes ErrorSizes::none() {
  ErrorSizes sizes;
  for (const ErrorKey& key : kErrorKeys) sizes.*key.size = 0.0;
  return sizes;
}

// Arm as it really is: offsets and gear errors of its joints, errors of its links, its bending under gravity. Its
// forward kinematics shares no code with the driver's.

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

// Track as it really is: its scale, and the displacement and rotation of the carriage along it.

class TrueTrack {
 public:
  /// Draws the errors. `base`: of the arm with the carriage at 0.
  TrueTrack(const Track& design, const BasePose& base, const ErrorSizes& sizes, std::uint64_t seed);

  /// Returns the base of the arm with the carriage at the place that its encoder states, m along L x. It rotates about
  /// the plate by which the arm hangs.
  [[nodiscard]] Eigen::Isometry3d T_L_base(double encoder_m) const;

  /// Returns the deviation of the carriage from its encoder at standstill number `number`, m.
  [[nodiscard]] double repeatability_m(std::uint64_t number) const;

 private:
  Track design_;
  BasePose base_;
  double scale_, repeatability_m_;
  Wave sideways_m_, height_m_, roll_rad_, pitch_rad_, yaw_rad_;
  std::uint64_t seed_;
};

/// Names what hangs on the plate of the target's arm.
enum class Mounted { kTarget, kBoard, kPatch };
inline constexpr std::size_t kMountedThings = 3;

class World {
 public:
  /// Draws the hidden errors. `T_flange_mounted`: as designed, in the order of Mounted.
  World(const TestbedDesign& laboratory, const std::array<Eigen::Isometry3d, kMountedThings>& T_flange_mounted,
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
