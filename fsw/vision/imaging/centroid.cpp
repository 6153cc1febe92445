#include "fsw/vision/imaging/centroid.h"

#include <algorithm>
#include <array>

#include "fsw/math/math.h"

namespace vbar::fsw::imaging {
namespace {

constexpr double kUnit = 16.0;  // units of a component's brightness per DN
/// Sigma of the window over that of a point's image (pixel included), and its minimum, px: in a narrower window a few
/// pixels dominate, and the centroid is biased towards their centres.
constexpr double kWindowWidth = 1.25;
constexpr double kMinWidth = 1.0;
constexpr int kMaxReach = 12;              // half a window, px
constexpr double kReach = 4.0;             // half a window, its sigmas
constexpr double kReachThatMatters = 2.0;  // a pixel beyond the edge has an effect
constexpr int kMaxIterations = 12;
constexpr double kSmallStep = 5e-4;  // px
constexpr double kFurthest = 2.5;    // from the brightest 3 x 3 pixels, px

/// exp(-(k - centre)^2 / (2 s^2)) at integers k from `first` on, by recurrence: the ratio of neighbours changes by a
/// constant factor.
struct Weights {
  std::array<double, 2 * kMaxReach + 1> value{};

  Weights(double centre, int first, int count, double s) {
    const double d = first - centre;
    const double inverse = 1.0 / (s * s);
    double weight = math::exp(-0.5 * d * d * inverse);
    double ratio = math::exp(-(d + 0.5) * inverse);
    const double factor = math::exp(-inverse);
    for (int k = 0; k < count; ++k) {
      value[static_cast<std::size_t>(k)] = weight;
      weight *= ratio;
      ratio *= factor;
    }
  }
};

struct Sums {
  double light = 0.0;       // weighted
  double x = 0.0, y = 0.0;  // first moments about the centre
  // If asked for:
  double variance_x = 0.0, variance_y = 0.0;  // variances of the first moments
  double xx = 0.0, yy = 0.0;                  // second moments
};

int nearest(double x) {
  return static_cast<int>(math::floor(x + 0.5));
}

class Window {
 public:
  Window(const ImageView& image, const Background& background, const Component& component, double sigma, double gain)
      : image_(image), sigma_(sigma), gain_(gain), reach_(std::min(static_cast<int>(kReach * sigma) + 1, kMaxReach)) {
    // Over a window the background is constant.
    level_ = background.level_dn(component.peak_x, component.peak_y);
    const double noise = background.noise_dn(component.peak_x, component.peak_y);
    noise_variance_ = noise * noise;
  }

  [[nodiscard]] Sums sums(double x, double y, bool with_variance) const {
    const int x_first = nearest(x) - reach_;
    const int y_first = nearest(y) - reach_;
    const int count = 2 * reach_ + 1;
    const Weights x_weights(x, x_first, count, sigma_);
    const Weights y_weights(y, y_first, count, sigma_);
    Sums all;
    for (int j = std::max(0, -y_first); j < std::min(count, image_.frame.height - y_first); ++j) {
      const std::uint16_t* row = image_.pixels.data() + static_cast<std::ptrdiff_t>(y_first + j) * image_.frame.width;
      const double dy = y_first + j - y;
      double light = 0.0;
      double light_x = 0.0;
      double light_xx = 0.0;
      double variance = 0.0;
      double variance_x = 0.0;
      for (int i = std::max(0, -x_first); i < std::min(count, image_.frame.width - x_first); ++i) {
        const int pixel = row[x_first + i];
        if (pixel == kMissingPixel) continue;
        const double weight = x_weights.value[static_cast<std::size_t>(i)];
        const double dx = x_first + i - x;
        const double above = pixel - level_;
        light += weight * above;
        light_x += weight * above * dx;
        if (!with_variance) continue;
        const double v = weight * weight * (noise_variance_ + gain_ * std::max(above, 0.0));
        variance += v;
        variance_x += v * dx * dx;
        light_xx += weight * above * dx * dx;
      }
      const double weight = y_weights.value[static_cast<std::size_t>(j)];
      all.light += weight * light;
      all.x += weight * light_x;
      all.y += weight * light * dy;
      all.xx += weight * light_xx;
      all.yy += weight * light * dy * dy;
      all.variance_x += weight * weight * variance_x;
      all.variance_y += weight * weight * variance * dy * dy;
    }
    return all;
  }

  /// Pixels near the centre are missing or beyond the edge.
  [[nodiscard]] bool is_cut(double x, double y) const {
    const int reach = static_cast<int>(kReachThatMatters * sigma_) + 1;
    const int cx = nearest(x);
    const int cy = nearest(y);
    const ImageFrame& f = image_.frame;
    if (cx < reach || cy < reach || cx + reach >= f.width || cy + reach >= f.height) return true;
    for (int j = cy - reach; j <= cy + reach; ++j) {
      const std::uint16_t* row = image_.pixels.data() + static_cast<std::ptrdiff_t>(j) * f.width;
      for (int i = cx - reach; i <= cx + reach; ++i) {
        if (row[i] == kMissingPixel) return true;
      }
    }
    return false;
  }

 private:
  ImageView image_;
  double sigma_;
  double gain_;
  int reach_;
  double level_ = 0.0;
  double noise_variance_ = 0.0;
};

}  // namespace

Centroid windowed_centroid(const ImageView& image, const Background& background, const Component& component,
                           double point_spread_sigma_px, double gain_dn_per_electron) {
  const double point = math::sqrt(point_spread_sigma_px * point_spread_sigma_px + 1.0 / 12.0);
  const double sigma = std::max(kWindowWidth * point, kMinWidth);
  const Window window(image, background, component, sigma, gain_dn_per_electron);
  Centroid c{.x = static_cast<double>(component.peak_x), .y = static_cast<double>(component.peak_y)};
  for (int k = 0; k < kMaxIterations; ++k) {
    const Sums sums = window.sums(c.x, c.y, false);
    if (!(sums.light > 0.0)) return c;
    const double dx = 2.0 * sums.x / sums.light;
    const double dy = 2.0 * sums.y / sums.light;
    c.x += dx;
    c.y += dy;
    if (!(math::abs(c.x - component.peak_x) < kFurthest) || !(math::abs(c.y - component.peak_y) < kFurthest)) return c;
    if (math::abs(dx) < kSmallStep && math::abs(dy) < kSmallStep) {
      c.is_found = true;
      break;
    }
  }
  if (!c.is_found) return c;
  const Sums sums = window.sums(c.x, c.y, true);
  // Derivative of the first moments with respect to the centre: for a point's image rather more than half the light.
  const double change_x = std::max(sums.light - sums.xx / (sigma * sigma), 0.5 * sums.light);
  const double change_y = std::max(sums.light - sums.yy / (sigma * sigma), 0.5 * sums.light);
  c.sigma_px = math::sqrt(0.5 * (sums.variance_x / (change_x * change_x) + sums.variance_y / (change_y * change_y)));
  // The window makes the image narrower: 1 / seen^2 = 1 / true^2 + 1 / sigma^2.
  const double seen = std::clamp(std::max(sums.xx, sums.yy) / sums.light, 0.0, 0.9 * sigma * sigma);
  c.radius_px = math::sqrt(seen / (1.0 - seen / (sigma * sigma)));
  c.is_cut = window.is_cut(c.x, c.y);
  return c;
}

Centroid component_centroid(const Background& background, const Component& component, double gain_dn_per_electron) {
  Centroid c{.is_found = component.flux > 0, .is_cut = component.is_cut};
  c.x = component.peak_x;
  c.y = component.peak_y;
  if (!c.is_found) return c;
  const double flux = static_cast<double>(component.flux);
  c.x = static_cast<double>(component.flux_x) / flux;
  c.y = static_cast<double>(component.flux_y) / flux;
  const double n = component.pixels;
  const double noise_dn = background.noise_dn(component.peak_x, component.peak_y);
  // Sums of squared distances from the centroid: of all pixels alike, and by their light
  const double spread_x =
      static_cast<double>(component.xx) - 2.0 * c.x * static_cast<double>(component.x) + n * c.x * c.x;
  const double spread_y =
      static_cast<double>(component.yy) - 2.0 * c.y * static_cast<double>(component.y) + n * c.y * c.y;
  const double light_x = static_cast<double>(component.flux_xx) - flux * c.x * c.x;
  const double light_y = static_cast<double>(component.flux_yy) - flux * c.y * c.y;
  const double variance =
      noise_dn * noise_dn * (spread_x + spread_y) + gain_dn_per_electron * (light_x + light_y) / kUnit;
  c.sigma_px = math::sqrt(0.5 * std::max(variance, 0.0)) / (flux / kUnit);
  return c;
}

double component_radius(const Component& component) {
  if (component.flux <= 0) return 0.0;
  const double flux = static_cast<double>(component.flux);
  const double x = static_cast<double>(component.flux_x) / flux;
  const double y = static_cast<double>(component.flux_y) / flux;
  const double xx = static_cast<double>(component.flux_xx) / flux - x * x;
  const double yy = static_cast<double>(component.flux_yy) / flux - y * y;
  const double xy = static_cast<double>(component.flux_xy) / flux - x * y;
  const double larger = 0.5 * (xx + yy) + math::hypot(0.5 * (xx - yy), xy);
  return math::sqrt(std::max(larger, 0.0));
}

}  // namespace vbar::fsw::imaging
