#include "hil_drivers/optical_stimulator/calibrate/dot_measurement.h"

#include <algorithm>
#include <cmath>

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

struct Place {
  int x, y;
};

/// Middle of the brightest 3 x 3 pixels; the search does not leave the part where the square fits.
Place brightest(const CameraPicture& picture, const Vector2& expected_px, const DotWindow& window) {
  const int margin = window.half_width_px;
  const auto low = [&](double at) { return std::max(margin, static_cast<int>(std::ceil(at - window.search_px))); };
  const auto high = [&](double at, int size) {
    return std::min(size - 1 - margin, static_cast<int>(std::floor(at + window.search_px)));
  };
  Place best{-1, -1};
  double best_sum = -1e300;
  for (int y = low(expected_px.y()); y <= high(expected_px.y(), picture.height); ++y)
    for (int x = low(expected_px.x()); x <= high(expected_px.x(), picture.width); ++x) {
      double sum = 0.0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) sum += picture.at(x + dx, y + dy);
      if (sum > best_sum) best_sum = sum, best = {x, y};
    }
  return best;
}

/// Median of the square's border, two pixels wide.
double border_median(const CameraPicture& picture, const Place& middle, int half) {
  std::vector<double> border;
  for (int dy = -half; dy <= half; ++dy)
    for (int dx = -half; dx <= half; ++dx)
      if (std::max(std::abs(dx), std::abs(dy)) > half - 2) border.push_back(picture.at(middle.x + dx, middle.y + dy));
  std::nth_element(border.begin(), border.begin() + static_cast<std::ptrdiff_t>(border.size() / 2), border.end());
  return border[border.size() / 2];
}

struct Moments {
  double light = 0.0;
  Vector2 first = Vector2::Zero();
  double second = 0.0;  ///< mean of both axes
};

Moments windowed(const CameraPicture& picture, const Vector2& centre, double background, const DotWindow& window,
                 int reach) {
  const double falloff = 0.5 / (window.sigma_px * window.sigma_px);
  const int cx = static_cast<int>(std::lround(centre.x())), cy = static_cast<int>(std::lround(centre.y()));
  Moments moments;
  for (int y = cy - reach; y <= cy + reach; ++y)
    for (int x = cx - reach; x <= cx + reach; ++x) {
      const Vector2 from_centre = Vector2(x, y) - centre;
      const double weight = std::exp(-falloff * from_centre.squaredNorm()) * (picture.at(x, y) - background);
      moments.light += weight;
      moments.first += weight * from_centre;
      moments.second += 0.5 * weight * from_centre.squaredNorm();
    }
  return moments;
}

void add_light(DotMeasurement& dot, const CameraPicture& picture, const Place& middle, double background, int half) {
  for (int dy = -half; dy <= half; ++dy)
    for (int dx = -half; dx <= half; ++dx) {
      const double dn = picture.at(middle.x + dx, middle.y + dy);
      dot.light_dn += dn - background;
      dot.peak_dn = std::max(dot.peak_dn, dn);
    }
}

}  // namespace

std::optional<DotMeasurement> measure_dot(const CameraPicture& picture, const Vector2& expected_px,
                                          const DotWindow& window) {
  const Place start = brightest(picture, expected_px, window);
  if (start.x < 0) return std::nullopt;
  const double background = border_median(picture, start, window.half_width_px);
  DotMeasurement dot{Vector2(start.x, start.y)};
  dot.background_dn = background;
  add_light(dot, picture, start, background, window.half_width_px);
  if (!(dot.peak_dn - background >= window.peak_min_dn)) return std::nullopt;
  const int reach = std::min(window.half_width_px - 3, static_cast<int>(std::ceil(4.0 * window.sigma_px)));
  Moments moments;
  for (int iteration = 0; iteration < 30; ++iteration) {
    moments = windowed(picture, dot.centre_px, background, window, reach);
    if (!(moments.light > 0.0)) return std::nullopt;
    const Vector2 step = 2.0 * moments.first / moments.light;  // the window halves the displacement of a like Gaussian
    dot.centre_px += step;
    if (!((dot.centre_px - Vector2(start.x, start.y)).norm() < 3.0)) return std::nullopt;
    if (step.squaredNorm() < 1e-10) break;
  }
  const double second = moments.second / moments.light, window2 = window.sigma_px * window.sigma_px;
  // The product of two Gaussians has the sum of their inverse variances.
  const double wide = second < 0.97 * window2 && second > 0.0 ? second * window2 / (window2 - second) : 32.0 * window2;
  dot.sigma_px = std::sqrt(wide);
  return dot;
}

}  // namespace vbar::optical_stimulator::calibrate
