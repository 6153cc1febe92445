#pragma once
// Counts of a display that show dots, and where in linear light those dots are.

#include <cstdint>
#include <optional>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::optical_stimulator::calibrate {

/// 8-bit counts of a display, row by row.
struct Counts {
  int width = 0, height = 0;
  std::vector<std::uint8_t> values;

  [[nodiscard]] static Counts black(int width, int height) { return grey(width, height, 0); }
  [[nodiscard]] static Counts grey(int width, int height, std::uint8_t count) {
    return {width, height,
            std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), count)};
  }
  [[nodiscard]] std::uint8_t& at(int x, int y) {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// Relative luminance of a count: ((D - first)/(255 - first))^gamma.
struct Response {
  double gamma = 2.2;
  double first_count = 0.0;

  [[nodiscard]] double luminance(double count) const;
  [[nodiscard]] std::uint8_t nearest_count(double luminance) const;
};

/// What the counts show, in linear light.
struct DrawnDot {
  fsw::Vector2 centre_px;    ///< centroid of the luminance of the rounded counts
  double full_pixels = 0.0;  ///< luminance, in full pixels
};

/// A Gaussian of a total luminance, its counts rounded, over 7 x 7 pixels. Rounding moves its centroid: the result is
/// where it is shown. Empty if it does not lie on the display.
std::optional<DrawnDot> draw_dot(Counts& counts, const fsw::Vector2& centre_px, double sigma_px, double full_pixels,
                                 const Response& response);

/// A square of equal counts about a pixel.
DrawnDot draw_square(Counts& counts, int x, int y, int half_width, std::uint8_t count, const Response& response);

}  // namespace vbar::optical_stimulator::calibrate
