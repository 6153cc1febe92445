#pragma once
// Offset, gain, read noise and hot pixels of the camera, from frames without dots.

#include <cstdint>
#include <vector>

#include "hil_drivers/optical_stimulator/calibrate/dot_measurement.h"
#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"

namespace vbar::optical_stimulator::calibrate {

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

}  // namespace vbar::optical_stimulator::calibrate
