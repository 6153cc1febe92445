#pragma once
// Camera images for the eye: stretched to shades of grey, as PNG.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vbar::report {

/// A camera image.
struct CameraPicture {
  int width = 0;
  int height = 0;
  std::span<const std::uint16_t> dn;  ///< rows from the top; 0xFFFF is a pixel that is missing
};

/// Levels of black and of white. The shade between them is asinh(softness * s) / asinh(softness) at the fraction s of
/// the way from one to the other, so that faint stars show beside bright ones (Lupton, Gunn, Szalay 1999).
struct Stretch {
  double black_dn = 0.0;
  double white_dn = 4095.0;
  double softness = 100.0;  ///< > 0
};

/// Returns the stretch from a little above the background's noise to the brightest pixel.
[[nodiscard]] Stretch stretch_for(const CameraPicture& picture);

/// A PNG in shades of grey; missing pixels are dark violet. Throws std::invalid_argument unless the number of pixels is
/// that of the picture's size, and that is not zero.
[[nodiscard]] std::vector<std::uint8_t> png_of(const CameraPicture& picture, const Stretch& stretch);

/// Pixels in one of libpng's formats as PNG. Throws std::runtime_error if the library fails.
[[nodiscard]] std::vector<std::uint8_t> encoded_png(int width, int height, unsigned format, const std::uint8_t* pixels,
                                                    const std::uint8_t* palette = nullptr);

/// Returns bytes as base64, for a page that contains them.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// data:image/png;base64,... for a page that contains its pictures.
[[nodiscard]] std::string png_data_uri(std::span<const std::uint8_t> png);

// A small colour picture, and its PNG.

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// Coordinates are pixels from the upper left corner. Pixels outside are left out.
class ColourPicture {
 public:
  /// Black. Throws std::invalid_argument without pixels.
  ColourPicture(int width, int height);

  void set(int x, int y, const Colour& colour);
  /// Adds `colour` by a share of 0 to 1 to what is there.
  void blend(int x, int y, const Colour& colour, double share);

  /// Throws std::runtime_error if the library fails.
  [[nodiscard]] std::vector<std::uint8_t> png() const;

 private:
  [[nodiscard]] std::size_t place(int x, int y) const;
  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

  int width_, height_;
  std::vector<std::uint8_t> rgb_;
};

}  // namespace vbar::report
