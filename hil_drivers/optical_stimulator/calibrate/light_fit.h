#pragma once
// Response of the display, and the evenness of the field, from the light of squares of equal counts.

#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"

namespace vbar::optical_stimulator::calibrate {

/// Holds the light of one square: rate per display pixel of the square, without the black level.
struct SquareLight {
  int place = 0;  ///< squares of one place have the same pixels
  double count = 0.0;
  double electrons_per_s = 0.0;
  double sigma = 0.0;  ///< standard deviation of the value
};

struct ResponseFit {
  Figure gamma, first_count;
  std::vector<double> full_electrons_per_s;  ///< by place: of a pixel at count 255
  double residual = 0.0;                     ///< rms, relative
};

/// Fits log light = log full(place) + gamma log((D - D0)/(255 - D0)): linear in all but D0, which is found by bisection
/// of intervals (golden section). Squares below ten standard deviations are not used. Throws std::runtime_error if
/// fewer than four levels remain.
[[nodiscard]] ResponseFit fit_response(const std::vector<SquareLight>& squares, int places);

/// Holds the light of a full pixel at a place of the display.
struct PlaceLight {
  fsw::Vector2 display_px;
  double electrons_per_s = 0.0;
};

struct UniformityFit {
  UniformityGrid grid;
  double mean_electrons_per_s = 0.0;  ///< mean of the full pixels, where the grid is 1
};

/// Fits a polynomial of degree `degree` in both axes through the places: pixels differ at random, the field is smooth.
[[nodiscard]] UniformityFit fit_uniformity(const std::vector<PlaceLight>& places, int width_px, int height_px,
                                           int degree);

}  // namespace vbar::optical_stimulator::calibrate
