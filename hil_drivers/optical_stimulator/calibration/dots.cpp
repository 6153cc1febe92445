#include "hil_drivers/optical_stimulator/calibration/dots.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vbar::optical_stimulator::calibrate {

using fsw::Vector2;

double Response::luminance(double count) const {
  return count > first_count ? std::pow((count - first_count) / (255.0 - first_count), gamma) : 0.0;
}

std::uint8_t Response::nearest_count(double luminance_wanted) const {
  if (!(luminance_wanted > 0.0)) return 0;
  const double exact = first_count + (255.0 - first_count) * std::pow(luminance_wanted, 1.0 / gamma);
  const double below = std::clamp(std::floor(exact), 0.0, 254.0);
  const bool is_lower = luminance_wanted - luminance(below) < luminance(below + 1.0) - luminance_wanted;
  return static_cast<std::uint8_t>(is_lower ? below : below + 1.0);
}

std::optional<DrawnDot> draw_dot(Picture& counts, const Vector2& centre_px, double sigma_px, double full_pixels,
                                 const Response& response) {
  constexpr int kHalf = 3;
  const int cx = static_cast<int>(std::lround(centre_px.x())), cy = static_cast<int>(std::lround(centre_px.y()));
  if (cx < kHalf || cy < kHalf || cx >= counts.width - kHalf || cy >= counts.height - kHalf) return std::nullopt;
  std::array<double, 49> weight{};
  double weights = 0.0;
  const auto weight_at = [&](int dx, int dy) {
    return std::exp(-0.5 * (Vector2(cx + dx, cy + dy) - centre_px).squaredNorm() / (sigma_px * sigma_px));
  };
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx)
      weights += weight[static_cast<std::size_t>(7 * (dy + 3) + dx + 3)] = weight_at(dx, dy);
  DrawnDot drawn{Vector2::Zero(), 0.0};
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      const double wanted = full_pixels * weight[static_cast<std::size_t>(7 * (dy + 3) + dx + 3)] / weights;
      const std::uint8_t count = response.nearest_count(wanted);
      counts.at(cx + dx, cy + dy) = count;
      const double luminance = response.luminance(count);
      drawn.full_pixels += luminance;
      drawn.centre_px += luminance * Vector2(cx + dx, cy + dy);
    }
  if (!(drawn.full_pixels > 0.0)) return std::nullopt;
  drawn.centre_px /= drawn.full_pixels;
  return drawn;
}

DrawnDot draw_square(Picture& counts, int x, int y, int half_width, std::uint8_t count, const Response& response) {
  for (int row = std::max(0, y - half_width); row <= std::min(counts.height - 1, y + half_width); ++row)
    for (int column = std::max(0, x - half_width); column <= std::min(counts.width - 1, x + half_width); ++column)
      counts.at(column, row) = count;
  const double side = 2.0 * half_width + 1.0;
  return {Vector2(x, y), side * side * response.luminance(count)};
}

namespace {

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
