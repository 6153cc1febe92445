#include "hil_drivers/optical_stimulator/calibrate/camera_noise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace vbar::optical_stimulator::calibrate {
namespace {

constexpr double kQuantisation_dn2 = 1.0 / 12.0;

/// Mean of the values within four standard deviations of their median.
Figure clipped_mean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  const double median = values[count / 2], spread = 0.5 * (values[count * 84 / 100] - values[count * 16 / 100]) + 1e-9;
  double sum = 0.0, kept = 0.0;
  for (const double value : values)
    if (std::abs(value - median) <= 4.0 * spread) sum += value, kept += 1.0;
  return {sum / kept, spread / std::sqrt(kept)};
}

}  // namespace

MeanVariance mean_variance(const FramePair& pair, int width, int height) {
  std::vector<double> differences, means;
  constexpr double kLow = 0.5 * (1.0 - kNoiseShare), kHigh = 0.5 * (1.0 + kNoiseShare);
  for (int y = static_cast<int>(kLow * height); y < static_cast<int>(kHigh * height); ++y)
    for (int x = static_cast<int>(kLow * width); x < static_cast<int>(kHigh * width); ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const double first = pair.first[at], second = pair.second[at];
      differences.push_back(first - second);
      means.push_back(0.5 * (first + second));
    }
  MeanVariance result;
  const Figure mean = clipped_mean(means), difference = clipped_mean(differences);
  const auto count = static_cast<double>(differences.size());
  double sum = 0.0, kept = 0.0;
  // Beyond six standard deviations lie only defects: of Gaussian noise nothing is lost.
  const double limit = 6.0 * difference.sigma * std::sqrt(count) + 3.0;
  for (const double d : differences)
    if (std::abs(d - difference.value) <= limit) sum += (d - difference.value) * (d - difference.value), kept += 1.0;
  result.mean_dn = mean.value;
  result.mean_sigma_dn = mean.sigma;
  result.variance_dn2 = 0.5 * sum / kept - kQuantisation_dn2;
  result.variance_sigma_dn2 = (result.variance_dn2 + kQuantisation_dn2) * std::sqrt(2.0 / kept);
  return result;
}

GainFit fit_gain(const MeanVariance& black, const std::vector<MeanVariance>& grey) {
  // Slope through the black point, weighted by the variances' own uncertainties.
  double weights = 0.0, sum = 0.0;
  for (const MeanVariance& level : grey) {
    const double signal = level.mean_dn - black.mean_dn;
    if (!(signal > 10.0)) continue;
    const double sigma = std::hypot(level.variance_sigma_dn2, black.variance_sigma_dn2) / signal;
    sum += (level.variance_dn2 - black.variance_dn2) / signal / (sigma * sigma);
    weights += 1.0 / (sigma * sigma);
  }
  if (!(sum > 0.0)) throw std::runtime_error("noise: the variance of grey frames does not grow with their mean");
  const double gain = sum / weights, gain_sigma = 1.0 / std::sqrt(weights);
  if (!(black.variance_dn2 > 0.0)) throw std::runtime_error("noise: black frames have no noise");
  const double noise = std::sqrt(black.variance_dn2) / gain;
  return {{gain, gain_sigma},
          {noise, noise * std::hypot(0.5 * black.variance_sigma_dn2 / black.variance_dn2, gain_sigma / gain)}};
}

BlackFit fit_black(const CameraPicture& short_exposure, double short_s, const CameraPicture& long_exposure,
                   double long_s, double noise_dn) {
  const double span_s = long_s - short_s;
  std::vector<double> rates(short_exposure.dn.size()), values(short_exposure.dn.begin(), short_exposure.dn.end());
  for (std::size_t k = 0; k < rates.size(); ++k)
    rates[k] = (static_cast<double>(long_exposure.dn[k]) - static_cast<double>(short_exposure.dn[k])) / span_s;
  const Figure level = clipped_mean(values), rate = clipped_mean(rates);
  BlackFit fit;
  fit.background_dn_per_s = rate;
  fit.offset_dn = {level.value - rate.value * short_s, std::hypot(level.sigma, rate.sigma * short_s)};
  const double limit = 8.0 * noise_dn / span_s;
  for (std::size_t k = 0; k < rates.size(); ++k)
    if (rates[k] - rate.value > limit)
      fit.hot_pixels.push_back(
          {static_cast<int>(k) % short_exposure.width, static_cast<int>(k) / short_exposure.width, rates[k]});
  return fit;
}

void repair(CameraPicture& picture, const std::vector<HotPixel>& hot_pixels) {
  for (const HotPixel& hot : hot_pixels) {
    float* const row = picture.dn.data() + static_cast<std::ptrdiff_t>(hot.y) * picture.width;
    const int left = hot.x > 0 ? hot.x - 1 : hot.x + 1, right = hot.x + 1 < picture.width ? hot.x + 1 : hot.x - 1;
    row[hot.x] = 0.5F * (row[left] + row[right]);
  }
}

}  // namespace vbar::optical_stimulator::calibrate
