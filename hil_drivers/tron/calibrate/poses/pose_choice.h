#pragma once
// Postures at which the camera sees the board, as different from each other as the testbed permits.

#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "hil_drivers/tron/calibrate/board/board_design.h"
#include "hil_drivers/tron/calibration_file/calibration.h"

namespace vbar::tron::calibrate {

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
[[nodiscard]] std::vector<Posture> choose_postures(const BenchFile& bench, const LensCalibration& lens,
                                                   const BoardDesign& board, int count, std::uint64_t seed,
                                                   const PoseGoals& goals = {}, const PostureFilter& filter = {});

/// Returns a filter that accepts postures free of collisions, with the camera's cable within its limit.
[[nodiscard]] PostureFilter free_postures(const BenchFile& bench);

/// Returns a frame with that z (unit), as R_L_frame; its x is level.
[[nodiscard]] fsw::Matrix3 looking_along(const fsw::Vector3& z);

}  // namespace vbar::tron::calibrate
