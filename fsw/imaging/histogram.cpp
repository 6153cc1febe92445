#include "fsw/imaging/histogram.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {
namespace {

constexpr double kClip = 3.0;
constexpr int kMaxIterations = 6;
/// Smallest sigma, that of equal integers: rounding alone has a standard deviation of sqrt(1/12).
constexpr double kMinSigma = 0.28867513459481287;
constexpr double kQuartilesPerSigma = 1.3489795003921634;  // from the lower to the upper

/// The values that a quarter, a half and three quarters of the samples do not exceed.
std::array<int, 3> quartiles(std::span<const std::uint16_t> counts, int total) {
  std::array<int, 3> values{};
  std::size_t found = 0;
  int below = 0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    below += counts[k];
    while (found < 3 && 4 * below >= (static_cast<int>(found) + 1) * total) values[found++] = static_cast<int>(k);
    if (found == 3) break;
  }
  return values;
}

/// Variance of a Gaussian truncated at +-k sigma, as part of the complete one's.
double remaining_variance(double k) {
  const double density = math::exp(-0.5 * k * k) * 0.3989422804014327;  // 1 / sqrt(2 pi)
  return 1.0 - 2.0 * k * density / math::erf(k * 0.7071067811865476);
}

}  // namespace

ClippedMoments clipped_moments(std::span<const std::uint16_t> counts, int total) {
  const auto [lower, median, upper] = quartiles(counts, total);
  ClippedMoments moments{static_cast<double>(median), std::max((upper - lower) / kQuartilesPerSigma, 2.0 * kMinSigma)};
  const int last = static_cast<int>(counts.size()) - 1;
  int first_before = -1;
  int end_before = -1;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double reach = kClip * moments.sigma;
    const int first = std::clamp(static_cast<int>(math::floor(moments.mean - reach)) + 1, 0, last);
    const int end = std::clamp(static_cast<int>(math::floor(moments.mean + reach)), first, last) + 1;
    if (first == first_before && end == end_before) break;
    first_before = first;
    end_before = end;
    std::int64_t n = 0;
    std::int64_t sum = 0;
    std::int64_t squares = 0;
    for (int k = first; k < end; ++k) {
      const std::int64_t count = counts[static_cast<std::size_t>(k)];
      const std::int64_t x = k - median;
      n += count;
      sum += count * x;
      squares += count * x * x;
    }
    if (n == 0) break;
    const double mean = static_cast<double>(sum) / static_cast<double>(n);
    const double variance = static_cast<double>(squares) / static_cast<double>(n) - mean * mean;
    // An integer represents all values rounded to it, so that the cut lies half beyond the outermost.
    const double k = std::max(0.5 * (end - first) / std::max(moments.sigma, kMinSigma), 1.0);
    moments.mean = median + mean;
    moments.sigma = std::max(math::sqrt(std::max(variance, 0.0) / remaining_variance(k)), kMinSigma);
  }
  return moments;
}

}  // namespace vbar::fsw::imaging
