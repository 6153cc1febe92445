#pragma once
// Pictures of a display that show dots, and the places of those dots in linear light.

#include <cstdint>
#include <optional>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/pictures/display_light.h"

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

// Position, light and width of a dot in a picture of the camera.

/// Holds pixels of the whole detector, DN, row by row; a mean over frames.
struct CameraPicture {
  int width = 0, height = 0;
  std::vector<float> dn;

  [[nodiscard]] double at(int x, int y) const {
    return static_cast<double>(
        dn[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]);
  }
};

struct DotWindow {
  double search_px = 8.0;     ///< the dot is the brightest 3 x 3 pixels within this distance of the expected place
  double sigma_px = 1.6;      ///< Gaussian window of centroid and width
  int half_width_px = 14;     ///< square whose sum is the dot's light; its border is the background
  double peak_min_dn = 20.0;  ///< above the background
};

struct DotMeasurement {
  fsw::Vector2 centre_px;  ///< an integer is the centre of a pixel
  double light_dn = 0.0;   ///< sum over the square above the background
  double sigma_px = 0.0;   ///< Gaussian with this windowed second moment, as sampled by the pixels
  double peak_dn = 0.0;    ///< highest pixel, background included
  double background_dn = 0.0;
};

/// Measures a dot by the iterated Gaussian-weighted centroid (SExtractor's windowed positions, docs of SExtractor 2.19,
/// section 10.7.1). Empty if there is no light, if the square reaches beyond the picture, or if the iteration leaves
/// the search area.
[[nodiscard]] std::optional<DotMeasurement> measure_dot(const CameraPicture& picture, const fsw::Vector2& expected_px,
                                                        const DotWindow& window);

}  // namespace vbar::optical_stimulator::calibrate
