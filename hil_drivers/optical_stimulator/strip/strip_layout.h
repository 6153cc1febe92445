#pragma once
// Frame strip: rows of the camera above the image, read with it, in which the display shows the number of its picture.
//
//   rows 0 to 7    black
//   rows 8 to 27   24 cells of 20 x 20 camera pixels, in the middle of the rows
//   rows 28 to 47  black: the halo of the lens (sigma 4 px) does not reach the image
//
// Cells from the left: black, white (references), 16 bits of the frame's number, 4 bits of check, most significant
// first, white, white (with the references a mark: the strip read backwards begins with white, white).

#include <array>
#include <cstdint>

#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::optical_stimulator {

inline constexpr int kStripRows = 48;
inline constexpr int kCells = 24, kCellSide = 20, kCellsTop = 8;
inline constexpr int kNumberBits = 16, kCheckBits = 4;

/// State of each cell: white or black.
using Cells = std::array<bool, kCells>;

[[nodiscard]] Cells cells_of(std::uint16_t frame);

/// Returns the region that is read: that of the image and the strip above it. Throws std::invalid_argument if the
/// detector has no rows for it or the image is narrower than the strip.
[[nodiscard]] twins::camera::Region region_with_strip(const twins::camera::Region& image);

/// Returns the column of the left edge of the cells in a region of that width.
[[nodiscard]] constexpr int cells_left(int width) {
  return (width - kCells * kCellSide) / 2;
}

}  // namespace vbar::optical_stimulator
