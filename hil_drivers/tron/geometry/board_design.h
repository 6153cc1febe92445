#pragma once
// The calibration board as designed: a ChArUco board of OpenCV 4.6 (DICT_4X4_50, 10 x 7 squares of 50 mm) with a white
// patch below it, on a plate that takes the place of the mock-up on the flange of the target's arm.
//
// Board frame B: origin in the middle of the squares, x to the right and y down for whom looks at it, z into the board.
// The plate is square to the flange's z, which comes out of the board towards the viewer: the arm is behind the plate.

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron::calibrate {

struct BoardDesign {
  int columns = 10, rows = 7;
  double square_m = 0.050;
  double marker_m = 0.036;  ///< with its black border
  double margin_m = 0.020;  ///< white, on the left, right and upper side
  double patch_m = 0.070;   ///< white, below the squares: for the light of the sources
  double white_albedo = 0.80, black_albedo = 0.04;
  double plate_thickness_m = 0.005;

  [[nodiscard]] double width_m() const { return columns * square_m; }
  [[nodiscard]] double height_m() const { return rows * square_m; }
  /// Returns the number of inner corners of the squares.
  [[nodiscard]] int corner_count() const { return (columns - 1) * (rows - 1); }
  /// Returns a corner by its number, row by row from the upper left one, in B.
  [[nodiscard]] fsw::Vector3 corner(int id) const;
  /// Returns the corners of the white patch in B: upper left, upper right, lower right, lower left, 5 mm off its edges.
  [[nodiscard]] std::array<fsw::Vector3, 4> patch() const;
};

/// Holds a rectangle of the board, corners in B (z = 0): upper left, upper right, lower right, lower left.
struct BoardQuad {
  std::array<fsw::Vector3, 4> corners_B;
  bool is_white = false;
};

/// Returns all of the plate's front, without gap or overlap. Only edges of white to black matter; where a rectangle's
/// corner is on the edge of another a renderer may need the plate behind.
[[nodiscard]] std::vector<BoardQuad> board_quads(const BoardDesign& design = {});

/// Returns the plate's front as one rectangle.
[[nodiscard]] BoardQuad board_plate(const BoardDesign& design = {});

/// Returns T_F_B as designed: at the stand-off of the mock-up's face.
[[nodiscard]] Eigen::Isometry3d T_flange_board(const TestbedDesign& bench);

/// Returns T_T_B, which is exact, since the board is held by the same mount as the mock-up. With the testbed's true
/// mount X_T the board is at T_flange_T T_T_B.
[[nodiscard]] Eigen::Isometry3d T_target_board(const TestbedDesign& bench);

}  // namespace vbar::tron::calibrate
