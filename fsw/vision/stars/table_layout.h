#pragma once
// Geometry that the star tables share with the program that makes them (toolchains/star_tables): division of the sky
// into cells, and the steps of the pair table. Integer arithmetic where possible, so that both compilers agree.

#include <cstdint>

namespace vbar::fsw::stars {

/// Number of cells along the edge of a face. The sky is divided into the six faces of a cube around the observer, each
/// face into n x n cells. Fine cells answer "which star is here?", coarse ones "which stars are near here?".
inline constexpr int kFineEdge = 128;
inline constexpr int kCoarseEdge = 16;
/// Number of the finest cells along an edge. Each only states whether it contains a star, in one bit, by which most
/// searches end.
inline constexpr int kOccupancyEdge = 512;
inline constexpr int kOccupancyWords = 6 * kOccupancyEdge * kOccupancyEdge / 32;
inline constexpr int kFineCells = 6 * kFineEdge * kFineEdge;
inline constexpr int kCoarseCells = 6 * kCoarseEdge * kCoarseEdge;
/// Largest distance of a point of a coarse cell from the cell's middle, rad: half the diagonal of a cell in the middle
/// of a face, where cells are largest (0.0882), rounded up.
inline constexpr double kCoarseRadius = 0.0890;

/// Margin of fine cells, rad (100 arcsec). A fine cell lists every star within this distance of the cell, so that one
/// cell is sufficient to find the stars within this distance of a direction.
inline constexpr double kCellMargin = 4.8481e-4;

/// Directions are integers: components times 2^30.
inline constexpr double kDirectionUnit = 1.0 / 1073741824.0;
/// Pairs of stars are sorted by their chord (distance of the tips of the unit vectors) in steps of 2^-17 (1.6 arcsec).
inline constexpr double kChordStep = 1.0 / 131072.0;
/// Shortest and longest pair, steps: 1.5 and 8 degrees.
inline constexpr int kFirstChord = 3431;
inline constexpr int kLastChord = 18287;
inline constexpr int kChordSteps = kLastChord - kFirstChord + 1;

/// Returns the number of the cell that a direction (of any length but zero) points to, for `edge` cells along each edge
/// of a face.
constexpr int cell_of(double x, double y, double z, int edge) {
  const double ax = x < 0.0 ? -x : x;
  const double ay = y < 0.0 ? -y : y;
  const double az = z < 0.0 ? -z : z;
  int face = 0;
  double major = ax, u = y, v = z;
  if (ay > ax && ay >= az) {
    face = 1;
    major = ay, u = z, v = x;
  } else if (az > ax && az > ay) {
    face = 2;
    major = az, u = x, v = y;
  }
  if ((face == 0 ? x : face == 1 ? y : z) < 0.0) face += 3;
  const double scale = 0.5 * edge / major;
  const int column = static_cast<int>(u * scale + 0.5 * edge);
  const int row = static_cast<int>(v * scale + 0.5 * edge);
  const int last = edge - 1;  // u == major would be one too many
  return (face * edge + (row > last ? last : row)) * edge + (column > last ? last : column);
}

/// Direction (not of unit length) of the middle of a cell.
struct CellMiddle {
  double x, y, z;
};
constexpr CellMiddle middle_of_cell(int cell, int edge) {
  const int face = cell / (edge * edge);
  const double u = (2.0 * (cell % edge) + 1.0) / edge - 1.0;
  const double v = (2.0 * (cell / edge % edge) + 1.0) / edge - 1.0;
  const double major = face < 3 ? 1.0 : -1.0;
  switch (face % 3) {
    case 0:
      return {major, u, v};
    case 1:
      return {v, major, u};
    default:
      return {u, v, major};
  }
}

}  // namespace vbar::fsw::stars
