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
#include <functional>
#include <span>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/pictures/display_light.h"
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

// Draws the frame strip on the display.

/// Returns the camera pixel (of the detector) that a pixel of the display illuminates.
using CameraPixelOf = std::function<fsw::Vector2(const fsw::Vector2& display_pixel)>;

class FrameStrip {
 public:
  /// `region`: that is read, the strip's rows first; `white_electrons`: a camera pixel and exposure in a white cell.
  /// `area`: of the display, in which all pixels of the strip lie. Throws std::runtime_error if the display does not
  /// reach all cells.
  FrameStrip(const twins::camera::Region& region, const DisplayLight& light, const CameraPixelOf& camera_pixel_of,
             const twins::camera::Region& area, double white_electrons);

  /// Replaces the pixels of all cells.
  void draw(std::uint16_t frame, Picture& picture) const;

  /// Returns the light of a camera pixel in the white reference cell, as its counts give: near the electrons asked for.
  [[nodiscard]] double white_electrons() const { return white_electrons_; }

 private:
  struct CellPixel {
    int x = 0, y = 0, cell = 0;
    std::uint8_t white = 0;
  };

  std::vector<CellPixel> pixels_;
  double white_electrons_ = 0.0;
};

// Reader of the frame strip in an image of the camera.

enum class StripStatus {
  kRead,
  kNone,      ///< no cell differs from the others
  kMirrored,  ///< left and right are exchanged
  kDamaged,   ///< mark or check are wrong: covered, or read in part
};

struct StripReading {
  StripStatus status = StripStatus::kNone;
  std::uint16_t frame = 0;  ///< if it has been read
  double black_dn = 0.0;    ///< mean of the darkest cell
  double white_dn = 0.0;    ///< level of the brightest cells; if the strip has been read: of the references
};

/// Reads the strip of `dn`: an image of that width, the strip's rows first; at least kStripRows rows. Cells that differ
/// by less than `contrast_dn` are not a strip. Throws std::invalid_argument for an image without the rows.
[[nodiscard]] StripReading read_strip(std::span<const std::uint16_t> dn, int width, double contrast_dn);

}  // namespace vbar::optical_stimulator
