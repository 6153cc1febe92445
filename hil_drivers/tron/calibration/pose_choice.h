#pragma once
// Postures at which the camera sees the board, as different from each other as the testbed permits.

#include <array>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/lights/photometry.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::calibrate {

// Joints for poses of camera and board in the laboratory, by the testbed as designed.

class Reach {
 public:
  /// Keeps all branches `limit_margin_rad` from the limits of their axes.
  Reach(const TestbedDesign& bench, double limit_margin_rad);

  /// Returns one of the branches that are within the limits, drawn at random.
  [[nodiscard]] std::optional<Posture> posture(const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_B,
                                               double carriage_m, engine::RandomStream& random) const;

 private:
  [[nodiscard]] std::optional<Joints> joints(const Arm& arm, const Eigen::Isometry3d& T_base_flange,
                                             engine::RandomStream& random) const;

  ArmPair arms_;
  AxisLimits track_;
  double limit_margin_rad_;
  Eigen::Isometry3d T_B_T_;
};

struct PoseGoals {
  double range_low_m = 1.2, range_high_m = 5.6;
  double tilt_high_rad = std::numbers::pi / 4.0;          ///< largest tilt of the board to the line of sight
  double yaw_high_rad = 40.0 * std::numbers::pi / 180.0;  ///< largest angle of the line of sight to L x
  double pitch_high_rad = 25.0 * std::numbers::pi / 180.0;
  double target_spread_m = 0.3;   ///< distance of the board's place from the middle of the lamp's beam
  double carriage_ahead_m = 0.8;  ///< largest distance of the camera from the carriage along the track
  double share_in_image = 0.7;    ///< smallest share of the board's corners in the image
  double limit_margin_rad = 0.07;
};

/// Returns true for a posture that may be used: no collision, cable within its limit.
using PostureFilter = std::function<bool(const Posture&)>;

/// Chooses `count` postures by the chain as designed; ranges and carriage places are spread evenly, all else is random.
/// Sorted along the track, so that moves are short. Throws std::runtime_error if the testbed has too few such postures.
[[nodiscard]] std::vector<Posture> choose_postures(const TestbedDesign& bench, const LensCalibration& lens,
                                                   const BoardDesign& board, int count, std::uint64_t seed,
                                                   const PoseGoals& goals = {}, const PostureFilter& filter = {});

/// Returns a filter that accepts postures free of collisions, with the camera's cable within its limit.
[[nodiscard]] PostureFilter free_postures(const TestbedDesign& bench);

/// Returns a frame with that z (unit), as R_L_frame; its x is level.
[[nodiscard]] fsw::Matrix3 looking_along(const fsw::Vector3& z);

// Postures at which the sources of light shine on the white patch of the board and the camera sees it.

struct PatchPosture {
  Posture posture;
  /// Names the sources (photometry.h) to be measured here, and the irradiance of the patch by them at full power
  /// as designed, to that of the lamp on an area that faces it.
  struct Light {
    std::size_t source = 0;
    double irradiance = 0.0;
  };
  std::vector<Light> lights;
};

/// One flag a source.
using SourceFlags = std::array<bool, kLightSources>;

/// Chooses postures for all sources but those of `measured`, while the lamp stands at `lamp_azimuth_rad`; throws
/// std::runtime_error that names those for which no posture was found.
[[nodiscard]] std::vector<PatchPosture> choose_patch_postures(const TestbedDesign& bench, const LensCalibration& lens,
                                                              const BoardDesign& board, double lamp_azimuth_rad,
                                                              std::uint64_t seed, const PostureFilter& filter = {},
                                                              const SourceFlags& measured = {});

}  // namespace vbar::tron::calibrate
