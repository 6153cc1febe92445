#pragma once
// Pictures of a display that show dots, and the places of those dots in linear light.

#include <cstdint>
#include <optional>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/counts/picture.h"

namespace vbar::optical_stimulator::calibrate {

/// Holds the relative luminance of a count: ((D - first)/(255 - first))^gamma.
struct Response {
  double gamma = 2.2;
  double first_count = 0.0;

  [[nodiscard]] double luminance(double count) const;
  [[nodiscard]] std::uint8_t nearest_count(double luminance) const;
};

/// Describes what the counts show, in linear light.
struct DrawnDot {
  fsw::Vector2 centre_px;    ///< centroid of the luminance of the rounded counts
  double full_pixels = 0.0;  ///< luminance, in full pixels
};

/// Draws a Gaussian of a total luminance, its counts rounded, over 7 x 7 pixels. Rounding moves its centroid: the
/// result is the place at which it is shown. Empty if it does not lie on the display.
std::optional<DrawnDot> draw_dot(Picture& counts, const fsw::Vector2& centre_px, double sigma_px, double full_pixels,
                                 const Response& response);

/// Draws a square of equal counts about a pixel.
DrawnDot draw_square(Picture& counts, int x, int y, int half_width, std::uint8_t count, const Response& response);

}  // namespace vbar::optical_stimulator::calibrate
