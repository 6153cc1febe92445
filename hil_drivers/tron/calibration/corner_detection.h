#pragma once
// Corners of the calibration board in an image.

#include <cstdint>
#include <span>
#include <vector>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/geometry/board_design.h"

namespace vbar::tron::calibrate {

/// Holds pixels row by row; an integer is the centre of a pixel.
struct GrayImage {
  int width = 0, height = 0;
  std::span<const std::uint16_t> pixels;
};

struct DetectionSettings {
  /// OpenCV 4.6 gives interpolated corners half a pixel too far right and low; a search for the saddle point of the
  /// light at each of them corrects that. False shows what the library does.
  bool is_refined = true;
  int window_low_px = 2, window_high_px = 8;  ///< half the side of the search, a fifth of a square between these
  double outlier_px = 3.0;                    ///< distance of a corner from the plane that the others span
};

/// Returns corners in the order of their numbers; empty if the board is not seen. Throws std::invalid_argument for an
/// image whose size is not that of its pixels.
[[nodiscard]] std::vector<Corner> detect_corners(const GrayImage& image, const BoardDesign& board,
                                                 const DetectionSettings& settings = {});

}  // namespace vbar::tron::calibrate
