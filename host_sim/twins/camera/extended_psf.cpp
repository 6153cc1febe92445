#include "host_sim/twins/camera/extended_psf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "host_sim/engine/wide_loops.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector2;

// Points come in rows up to half a pixel apart. A coarser grid than this aliases with them, and the spread no longer
// suppresses that.
constexpr double kCoarsestStep = 0.67;  // sigmas of the core

/// Integrals over pixel 0 of a Gaussian at `offset` pixels, for offsets of -reach to reach by steps of 1 / nodes; the
/// middle one is its own mirror image. Their sums over all pixels are made 1 for each place in a pixel.
std::vector<float> pixel_weights(double sigma, int nodes, int reach_nodes) {
  std::vector<double> weights(static_cast<std::size_t>(2 * reach_nodes + 1));
  const double scale = M_SQRT1_2 / sigma;
  for (int k = -reach_nodes; k <= reach_nodes; ++k) {
    const double offset = static_cast<double>(k) / nodes;
    weights[static_cast<std::size_t>(k + reach_nodes)] =
        0.5 * (std::erf((offset + 0.5) * scale) - std::erf((offset - 0.5) * scale));
  }
  std::vector<float> normalised(weights.size());
  for (std::size_t place = 0; place < static_cast<std::size_t>(nodes); ++place) {
    double sum = 0.0;
    for (std::size_t k = place; k < weights.size(); k += static_cast<std::size_t>(nodes)) sum += weights[k];
    for (std::size_t k = place; k < weights.size(); k += static_cast<std::size_t>(nodes))
      normalised[k] = static_cast<float>(weights[k] / sum);
  }
  return normalised;
}

/// Weights of the nodes before, at and after a point that lies `u` from the middle one, -1/2 to 1/2: a quadratic
/// B-spline. Its sum is 1, its mean u and its variance a quarter at every position of the point.
std::array<float, 3> spline_weights(float u) {
  return {0.5F * (0.5F - u) * (0.5F - u), 0.75F - u * u, 0.5F * (0.5F + u) * (0.5F + u)};
}

VBAR_WIDE_LOOPS void add_scaled(float factor, const float* from, std::size_t count, float* to) {
  for (std::size_t k = 0; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace

ExtendedPsf::ExtendedPsf(const Settings& settings)
    : settings_(settings),
      nodes_a_pixel_(std::clamp(static_cast<int>(std::ceil(1.0 / (kCoarsestStep * settings.core_sigma_px))), 2, 8)) {
  const double step = 1.0 / nodes_a_pixel_;
  const double variance = settings.core_sigma_px * settings.core_sigma_px;
  core_sigma_ = std::sqrt(std::max(variance - step * step / 4.0, 0.25 * variance));
  halo_variance_ = settings.halo_sigma_px * settings.halo_sigma_px - variance;
}

/// A body beside the camera has points all over the half space before it; the grid covers the relevant ones.
std::span<const ImagePoint> ExtendedPsf::within_reach(std::span<const ImagePoint> points, double margin,
                                                      const Region& region) {
  const auto matters = [&](const ImagePoint& point) {
    const double x = point.pixel.x() - region.x, y = point.pixel.y() - region.y;
    return x > -margin && y > -margin && x < region.width + margin && y < region.height + margin;
  };
  if (std::ranges::all_of(points, matters)) return points;
  near_.clear();
  std::ranges::copy_if(points, std::back_inserter(near_), matters);
  return near_;
}

void ExtendedPsf::add(std::span<const ImagePoint> all_points, const Vector2& all_smear_px, double core_reach,
                      double halo_reach, PhotonImage& image) {
  // Nor is the motion of such a body on the detector meaningful.
  const double longest = image.region.width + image.region.height;
  const Vector2 smear_px = all_smear_px.norm() < longest ? all_smear_px : Vector2(Vector2::Zero());
  const double margin = core_reach + halo_reach + 0.5 * smear_px.norm() + 2.0;
  const std::span<const ImagePoint> points = within_reach(all_points, margin, image.region);
  if (points.empty()) return;
  Vector2 low = points[0].pixel, high = low;
  for (const ImagePoint& point : points) {
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  low -= 0.5 * smear_px.cwiseAbs();
  high += 0.5 * smear_px.cwiseAbs();
  const auto floor_of = [](double v) { return static_cast<int>(std::floor(v)); };
  Box from{floor_of(low.x()) - 1, floor_of(low.y()) - 1, 0, 0};  // a node is left over on each side
  from.width = floor_of(high.x()) + 2 - from.x;
  from.height = floor_of(high.y()) + 2 - from.y;
  gather(points, smear_px, from);

  // The part of the core beside the region still contributes its halo inside.
  const Region& region = image.region;
  const int beside = static_cast<int>(std::ceil(halo_reach)) + 1, reach = static_cast<int>(std::ceil(core_reach)) + 1;
  const int spread = reach + beside;
  const int left = std::max(from.x - spread, region.x - beside), top = std::max(from.y - spread, region.y - beside);
  const int right = std::min(from.x + from.width + spread, region.x + region.width + beside);
  const int bottom = std::min(from.y + from.height + spread, region.y + region.height + beside);
  if (left >= right || top >= bottom) return;
  const Box canvas{left, top, right - left, bottom - top};
  spread_core(from, canvas, core_reach);
  add_canvas(canvas_, 1.0 - settings_.halo_fraction, canvas, image);
  if (settings_.halo_fraction == 0.0) return;
  spread_halo(canvas, halo_reach);
  add_canvas(halo_, settings_.halo_fraction, canvas, image);
}

/// Onto the grid, node 0 of which is the middle of the box's first pixel.
void ExtendedPsf::gather(std::span<const ImagePoint> points, const Vector2& smear_px, const Box& box) {
  const double nodes = nodes_a_pixel_;
  grid_width_ = static_cast<std::size_t>(box.width * nodes_a_pixel_) + 1;
  grid_height_ = static_cast<std::size_t>(box.height * nodes_a_pixel_) + 1;
  grid_.assign(grid_width_ * grid_height_, 0.0F);
  // A smear shorter than a tenth of the core widens it by less than 0.1 %.
  const double length = smear_px.norm();
  const int pieces = length < 0.1 * settings_.core_sigma_px
                         ? 1
                         : static_cast<int>(std::min(std::ceil(3.0 * length / settings_.core_sigma_px), 6000.0));
  const Vector2 origin(box.x, box.y);
  for (const ImagePoint& point : points) {
    const auto light = static_cast<float>(point.electrons / pieces);
    for (int piece = 0; piece < pieces; ++piece) {
      const Vector2 place = nodes * (point.pixel + ((piece + 0.5) / pieces - 0.5) * smear_px - origin);
      const auto i =
          std::clamp(static_cast<std::size_t>(std::max(place.x() + 0.5, 0.0)), std::size_t{1}, grid_width_ - 2);
      const auto j =
          std::clamp(static_cast<std::size_t>(std::max(place.y() + 0.5, 0.0)), std::size_t{1}, grid_height_ - 2);
      const std::array<float, 3> across = spline_weights(static_cast<float>(place.x() - static_cast<double>(i)));
      const std::array<float, 3> down = spline_weights(static_cast<float>(place.y() - static_cast<double>(j)));
      float* node = &grid_[(j - 1) * grid_width_ + i - 1];
      for (const float share : down) {
        const float of_row = light * share;
        node[0] += of_row * across[0];
        node[1] += of_row * across[1];
        node[2] += of_row * across[2];
        node += grid_width_;
      }
    }
  }
}

/// Down the columns of nodes first, then along the rows, whose nodes are sorted by their place in a pixel before.
void ExtendedPsf::spread_core(const Box& from, const Box& canvas, double reach) {
  const int m = nodes_a_pixel_;
  const int reach_nodes = static_cast<int>(std::ceil((reach + 0.5) * m));
  const std::vector<float> weights = pixel_weights(core_sigma_, m, reach_nodes);
  const auto weight_of = [&](int offset) { return weights[static_cast<std::size_t>(offset + reach_nodes)]; };
  const int grid_width = static_cast<int>(grid_width_), grid_height = static_cast<int>(grid_height_);
  const int columns = (grid_width + m - 1) / m;  // columns of nodes of one place in a pixel
  canvas_.assign(static_cast<std::size_t>(canvas.width) * static_cast<std::size_t>(canvas.height), 0.0F);
  row_.resize(grid_width_);
  phases_.assign(static_cast<std::size_t>(columns * m), 0.0F);
  for (int y = 0; y < canvas.height; ++y) {
    const int middle = (canvas.y + y - from.y) * m;
    const int first = std::max(middle - reach_nodes, 0), last = std::min(middle + reach_nodes, grid_height - 1);
    if (first > last) continue;
    std::fill(row_.begin(), row_.end(), 0.0F);
    for (int j = first; j <= last; ++j)
      add_scaled(weight_of(j - middle), &grid_[static_cast<std::size_t>(j) * grid_width_], grid_width_, row_.data());
    for (int i = 0; i < grid_width; ++i)
      phases_[static_cast<std::size_t>(i % m * columns + i / m)] = row_[static_cast<std::size_t>(i)];
    float* const out = &canvas_[static_cast<std::size_t>(y) * static_cast<std::size_t>(canvas.width)];
    for (int offset = -reach_nodes; offset <= reach_nodes; ++offset) {
      const int phase = (offset % m + m) % m, shift = (offset - phase) / m;
      // Pixel x takes the node of column x + shift from the grid's first.
      const int to_column = canvas.x - from.x + shift;
      const int begin = std::max(0, -to_column), end = std::min(canvas.width, columns - to_column);
      if (begin >= end) continue;
      add_scaled(weight_of(offset), &phases_[static_cast<std::size_t>(phase * columns + begin + to_column)],
                 static_cast<std::size_t>(end - begin), out + begin);
    }
  }
}

/// Spreads the core's image, which has the pixel's width already.
void ExtendedPsf::spread_halo(const Box& canvas, double reach) {
  const int taps = static_cast<int>(std::ceil(reach));
  std::vector<float> weights(static_cast<std::size_t>(2 * taps + 1));
  double sum = 0.0;
  for (int k = -taps; k <= taps; ++k) sum += std::exp(-0.5 * k * k / halo_variance_);
  for (int k = -taps; k <= taps; ++k)
    weights[static_cast<std::size_t>(k + taps)] = static_cast<float>(std::exp(-0.5 * k * k / halo_variance_) / sum);
  const auto width = static_cast<std::size_t>(canvas.width);
  half_.assign(canvas_.size(), 0.0F);
  halo_.assign(canvas_.size(), 0.0F);
  for (int y = 0; y < canvas.height; ++y)
    for (int k = std::max(-taps, -y); k <= std::min(taps, canvas.height - 1 - y); ++k)
      add_scaled(weights[static_cast<std::size_t>(k + taps)], &canvas_[static_cast<std::size_t>(y + k) * width], width,
                 &half_[static_cast<std::size_t>(y) * width]);
  for (int y = 0; y < canvas.height; ++y) {
    const float* const row = &half_[static_cast<std::size_t>(y) * width];
    float* const out = &halo_[static_cast<std::size_t>(y) * width];
    for (int k = -taps; k <= taps; ++k) {
      const int begin = std::max(0, -k), end = std::min(canvas.width, canvas.width - k);
      if (begin < end)
        add_scaled(weights[static_cast<std::size_t>(k + taps)], row + begin + k, static_cast<std::size_t>(end - begin),
                   out + begin);
    }
  }
}

void ExtendedPsf::add_canvas(const std::vector<float>& light, double fraction, const Box& canvas,
                             PhotonImage& image) const {
  const Region& region = image.region;
  const int left = std::max(canvas.x, region.x), right = std::min(canvas.x + canvas.width, region.x + region.width);
  const int top = std::max(canvas.y, region.y), bottom = std::min(canvas.y + canvas.height, region.y + region.height);
  if (left >= right) return;
  for (int y = top; y < bottom; ++y)
    add_scaled(static_cast<float>(fraction),
               &light[static_cast<std::size_t>(y - canvas.y) * static_cast<std::size_t>(canvas.width) +
                      static_cast<std::size_t>(left - canvas.x)],
               static_cast<std::size_t>(right - left), &image.at(left, y));
}

}  // namespace vbar::twins::camera
