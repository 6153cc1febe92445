#include "fsw/imaging/blend.h"

#include <algorithm>
#include <utility>

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {
namespace {

constexpr double kSignificance = 4.0;

class Sums {
 public:
  Sums(const ImageView& image, const Background& background, const Component& component, double gain,
       double detection_sigmas)
      : image_(image), gain_(gain) {
    level_ = static_cast<int>(9.0 * background.level_dn(component.peak_x, component.peak_y) + 0.5);
    const double noise = background.noise_dn(component.peak_x, component.peak_y);
    variance_ = 9.0 * noise * noise;
    threshold_ = static_cast<int>(detection_sigmas * 3.0 * noise);
  }

  /// Returns the sum of 3 x 3 pixels, above the background; missing pixels are background. A component keeps off the
  /// image's outermost pixels, so all nine are there.
  [[nodiscard]] int at(int x, int y) const {
    int sum = -level_;
    for (int j = y - 1; j <= y + 1; ++j) {
      const std::uint16_t* row = image_.pixels.data() + static_cast<std::ptrdiff_t>(j) * image_.frame.width;
      for (int i = x - 1; i <= x + 1; ++i) sum += row[i] == kMissingPixel ? level_ / 9 : row[i];
    }
    return sum;
  }

  /// Returns true if none of its eight neighbours is greater, and none of the equal ones comes first.
  [[nodiscard]] bool is_maximum(int x, int y, const Component& c) const {
    const int here = at(x, y);
    for (int j = std::max(y - 1, c.y_min); j <= std::min(y + 1, c.y_max); ++j) {
      for (int i = std::max(x - 1, c.x_min); i <= std::min(x + 1, c.x_max); ++i) {
        const int other = at(i, j);
        const bool comes_first = j < y || (j == y && i < x);
        if (other > here || (other == here && comes_first)) return false;
      }
    }
    return true;
  }

  /// Returns true if the fainter of two peaks exceeds the minimum on the straight path between them.
  [[nodiscard]] bool are_apart(const Blend::Peak& bright, const Blend::Peak& faint) const {
    const int dx = faint.x - bright.x;
    const int dy = faint.y - bright.y;
    const int steps = std::max(dx < 0 ? -dx : dx, dy < 0 ? -dy : dy);
    int minimum = faint.sum_dn;
    for (int k = 1; k < steps; ++k) {
      const int x = bright.x + (2 * dx * k + (dx < 0 ? -steps : steps)) / (2 * steps);
      const int y = bright.y + (2 * dy * k + (dy < 0 ? -steps : steps)) / (2 * steps);
      minimum = std::min(minimum, at(x, y));
    }
    const double noise = math::sqrt(2.0 * (variance_ + gain_ * std::max(faint.sum_dn, 0)));
    return minimum > threshold_ && faint.sum_dn - minimum > kSignificance * noise;
  }

 private:
  ImageView image_;
  double gain_;
  int level_ = 0;  // level of nine pixels
  int threshold_ = 0;
  double variance_ = 0.0;  // variance of nine pixels without light
};

/// The brightest maxima, in order.
Blend maxima(const Sums& sums, const Component& c) {
  Blend found;
  for (int y = c.y_min; y <= c.y_max; ++y) {
    for (int x = c.x_min; x <= c.x_max; ++x) {
      if (!sums.is_maximum(x, y, c)) continue;
      Blend::Peak peak{x, y, sums.at(x, y)};
      for (std::size_t k = 0; k < found.count; ++k) {
        if (peak.sum_dn > found.peaks[k].sum_dn) std::swap(peak, found.peaks[k]);
      }
      if (found.count < Blend::kMaxPeaks) found.peaks[found.count++] = peak;
    }
  }
  return found;
}

}  // namespace

Blend separate(const ImageView& image, const Background& background, const Component& component,
               double gain_dn_per_electron, double detection_sigmas) {
  const Sums sums(image, background, component, gain_dn_per_electron, detection_sigmas);
  const Blend all = maxima(sums, component);
  Blend apart;
  for (std::size_t k = 0; k < all.count; ++k) {
    const Blend::Peak& peak = all.peaks[k];
    const auto stands_out = [&](const Blend::Peak& brighter) { return sums.are_apart(brighter, peak); };
    if (std::all_of(apart.peaks.begin(), apart.peaks.begin() + static_cast<std::ptrdiff_t>(apart.count), stands_out)) {
      apart.peaks[apart.count++] = peak;
    }
  }
  return apart;
}

}  // namespace vbar::fsw::imaging
