#pragma once
// A small colour picture to draw on, and its PNG.

#include <array>
#include <cstdint>
#include <vector>

namespace vbar::report {

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// Coordinates are pixels from the upper left corner; an integer is the centre of a pixel. What falls outside, or is no
/// number, is left out.
class ColourPicture {
 public:
  /// Black. Throws std::invalid_argument without pixels.
  ColourPicture(int width, int height);

  void set(int x, int y, const Colour& colour);
  /// So much of `colour`, 0 to 1, and the rest of what was there.
  void blend(int x, int y, const Colour& colour, double share);
  void line(double x0, double y0, double x1, double y1, const Colour& colour);
  void cross(double x, double y, double half_size, const Colour& colour);
  void box(double centre_x, double centre_y, double side, const Colour& colour);
  /// The curve of so many sigma of a covariance [xx, xy, yy].
  void ellipse(double x, double y, const std::array<double, 3>& covariance, double sigmas, const Colour& colour);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Colour at(int x, int y) const;  ///< inside only
  /// Throws std::runtime_error if the library fails.
  [[nodiscard]] std::vector<std::uint8_t> png() const;

 private:
  [[nodiscard]] std::size_t place(int x, int y) const;
  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

  int width_, height_;
  std::vector<std::uint8_t> rgb_;
};

}  // namespace vbar::report
