#pragma once
// A small colour picture, and its PNG.

#include <array>
#include <cstdint>
#include <vector>

namespace vbar::report {

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
