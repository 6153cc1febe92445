#pragma once
// Response of the display, and the evenness of the field, from the light of squares of equal counts.

#include <cstdint>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/calibration/dots.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"

namespace vbar::optical_stimulator::calibrate {

// Offset, gain, read noise and hot pixels of the camera, from frames without dots.

/// Holds two frames of the same scene.
struct FramePair {
  std::vector<std::uint16_t> first, second;
};

/// Holds the mean, and the variance of one frame by half the variance of the difference: the scene and fixed patterns
/// cancel.
struct MeanVariance {
  double mean_dn = 0.0, variance_dn2 = 0.0;
  double variance_sigma_dn2 = 0.0;
  double mean_sigma_dn = 0.0;
};

/// Width and height of the part of the detector whose noise is measured, about its middle.
inline constexpr double kNoiseShare = 0.3;

/// Returns mean and variance of that part of the detector; pixels that differ by more than six standard deviations are
/// left out.
[[nodiscard]] MeanVariance mean_variance(const FramePair& pair, int width, int height);

/// Fits the line variance = read variance + gain (mean - offset), by weighted least squares; `black` is the pair
/// without light. Throws std::runtime_error if the gain is not positive.
struct GainFit {
  Figure gain_dn_per_electron, read_noise_electrons;
};
[[nodiscard]] GainFit fit_gain(const MeanVariance& black, const std::vector<MeanVariance>& grey);

/// Fits mean black pictures at two exposures: offset at none, background rate, and pixels whose rate is far above it.
struct BlackFit {
  Figure offset_dn, background_dn_per_s;
  std::vector<HotPixel> hot_pixels;  ///< electrons_per_s holds DN/s here
};
[[nodiscard]] BlackFit fit_black(const CameraPicture& short_exposure, double short_s,
                                 const CameraPicture& long_exposure, double long_s, double noise_dn);

/// Replaces the hot pixels by the mean of their neighbours in the row.
void repair(CameraPicture& picture, const std::vector<HotPixel>& hot_pixels);

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
