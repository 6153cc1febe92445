#pragma once
// Camera images for the eye: stretched to shades of grey, with marks about what was found in them, as PNG.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vbar::report {

/// A camera image. Pixel coordinates are the detector's; an integer is the centre of a pixel.
struct CameraPicture {
  int width = 0;
  int height = 0;
  int origin_x = 0;  ///< of its first pixel
  int origin_y = 0;
  std::span<const std::uint16_t> dn;  ///< rows from the top; 0xFFFF is a pixel that is missing
};

/// What is black and what is white; between them asinh(softness * s) / asinh(softness) of the way s from one to the
/// other, so that faint stars show beside bright ones (Lupton, Gunn, Szalay 1999).
struct Stretch {
  double black_dn = 0.0;
  double white_dn = 4095.0;
  double softness = 100.0;  ///< > 0
};

/// From a little above the background's noise to the brightest pixel.
[[nodiscard]] Stretch stretch_for(const CameraPicture& picture);

enum class MarkShape { kBox, kCircle, kTriangle };  ///< red, green, blue

struct ImageMark {
  MarkShape shape = MarkShape::kBox;
  double x_px = 0.0, y_px = 0.0;
  double radius_px = 8.0;  ///< of the circle, and of the one inside box and triangle
};

/// A PNG, `enlargement` (>= 1) pixels for each of the image's either way. Marks may reach over the edge; those far
/// outside or at no number are left out. Throws
/// std::invalid_argument for a picture without pixels, or with another number of them than its size says.
[[nodiscard]] std::vector<std::uint8_t> png_of(const CameraPicture& picture, const Stretch& stretch,
                                               std::span<const ImageMark> marks, int enlargement = 1);

/// data:image/png;base64,... for a page that holds its pictures itself.
[[nodiscard]] std::string png_data_uri(std::span<const std::uint8_t> png);

}  // namespace vbar::report
