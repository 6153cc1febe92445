#include "host_sim/twins/camera/point_spread.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vbar::twins::camera {
namespace {

using fsw::Vector2;

constexpr double kLost = 0.05;  // electrons a pixel

float* row_of(PhotonImage& image, int y) {
  return image.electrons.data() +
         static_cast<std::size_t>(y - image.region.y) * static_cast<std::size_t>(image.region.width);
}

}  // namespace

// Minimum reaches, half widths: beyond 4.5 sigma lies 1.4e-5 of the core, beyond 3.3 sigma 2e-3 of the halo.
PointSpread::PointSpread(const OpticsSettings& optics)
    : components_{Component{1.0 - optics.halo_fraction, optics.point_spread_sigma_px, 4.5},
                  Component{optics.halo_fraction, optics.halo_sigma_px, 3.3}},
      wide_({optics.point_spread_sigma_px, optics.halo_sigma_px, optics.halo_fraction}) {}

double PointSpread::reach_px(const Component& component, double electrons) {
  const double peak = electrons * component.fraction / (2.0 * M_PI * component.sigma_px * component.sigma_px);
  const double sigmas = peak > kLost ? std::sqrt(2.0 * std::log(peak / kLost)) : 0.0;
  return component.sigma_px * std::max(sigmas, component.min_reach);
}

double PointSpread::reach_px(double electrons) const {
  return std::max(reach_px(components_[0], electrons), reach_px(components_[1], electrons));
}

/// Gauss-Legendre, three nodes for every sigma of the smear: moments correct to 1e-6.
void PointSpread::place_smear_nodes(const Vector2& smear_px, double sigma_px) {
  constexpr std::array<double, 3> kPlace{-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> kWeight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  constexpr double kMaxPieces = 2000.0;
  nodes_.clear();
  const double length = smear_px.norm();
  if (length < 1e-6) {
    nodes_.push_back({Vector2::Zero(), 1.0});
    return;
  }
  const double pieces = std::min(std::ceil(length / sigma_px), kMaxPieces);
  for (double piece = 0.0; piece < pieces; piece += 1.0)
    for (std::size_t i = 0; i < kPlace.size(); ++i)
      nodes_.push_back({((piece + 0.5 + 0.5 * kPlace[i]) / pieces - 0.5) * smear_px, kWeight[i] / pieces});
}

/// Pixels from `begin` to before `end` only; none if the reach ends outside of them.
void PointSpread::fill(Profile& profile, double centre, double reach, double sigma_px, int begin, int end) {
  profile.weights.clear();
  const double low = std::max(std::floor(centre - reach + 0.5), static_cast<double>(begin));
  const double high = std::min(std::floor(centre + reach + 0.5), static_cast<double>(end) - 1.0);
  if (!(low <= high)) return;
  profile.first = static_cast<int>(low);
  const int last = static_cast<int>(high);
  const double scale = M_SQRT1_2 / sigma_px;
  double before = std::erf((profile.first - 0.5 - centre) * scale);
  for (int pixel = profile.first; pixel <= last; ++pixel) {
    const double after = std::erf((pixel + 0.5 - centre) * scale);
    profile.weights.push_back(static_cast<float>(0.5 * (after - before)));
    before = after;
  }
}

void PointSpread::add(const ImagePoint& point, const Vector2& smear_px, PhotonImage& image) {
  const Region& region = image.region;
  for (const Component& component : components_) {
    const double reach = reach_px(component, point.electrons);
    place_smear_nodes(smear_px, component.sigma_px);
    for (const SmearNode& node : nodes_) {
      const Vector2 centre = point.pixel + node.offset;
      fill(across_, centre.x(), reach, component.sigma_px, region.x, region.x + region.width);
      if (across_.weights.empty()) continue;
      fill(down_, centre.y(), reach, component.sigma_px, region.y, region.y + region.height);
      const auto electrons = static_cast<float>(point.electrons * component.fraction * node.weight);
      for (std::size_t j = 0; j < down_.weights.size(); ++j) {
        float* const row = row_of(image, down_.first + static_cast<int>(j)) + (across_.first - region.x);
        const float factor = electrons * down_.weights[j];
        for (std::size_t i = 0; i < across_.weights.size(); ++i) row[i] += factor * across_.weights[i];
      }
    }
  }
}

void PointSpread::add(std::span<const ImagePoint> points, const Vector2& smear_px, PhotonImage& image) {
  if (add_wide(points, smear_px, image)) return;
  for (const Component& component : components_) add_component(component, points, smear_px, image);
}

/// False, and nothing is added, if the visible points are not wide.
bool PointSpread::add_wide(std::span<const ImagePoint> points, const Vector2& smear_px, PhotonImage& image) {
  if (!wide_.can_spread()) return false;
  double electrons = 0.0;
  for (const ImagePoint& point : points) electrons += point.electrons;
  const Region& region = image.region;
  const Vector2 margin = Vector2::Constant(reach_px(electrons) + 1.0) + 0.5 * smear_px.cwiseAbs();
  const Vector2 least = Vector2(region.x, region.y) - margin;
  const Vector2 most = Vector2(region.x + region.width, region.y + region.height) + margin;
  Vector2 low = most, high = least;
  near_points_.clear();
  for (const ImagePoint& point : points) {
    if (!((point.pixel.array() >= least.array()).all() && (point.pixel.array() <= most.array()).all())) continue;
    near_points_.push_back(point);
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  if (near_points_.empty() || (high - low).maxCoeff() <= kWide_px) return false;
  wide_.add(near_points_, smear_px, reach_px(components_[0], electrons), reach_px(components_[1], electrons), image);
  return true;
}

void PointSpread::add_component(const Component& component, std::span<const ImagePoint> points, const Vector2& smear_px,
                                PhotonImage& image) {
  const Region& region = image.region;
  double electrons = 0.0;
  for (const ImagePoint& point : points) electrons += point.electrons;
  const double reach = reach_px(component, electrons);
  place_smear_nodes(smear_px, component.sigma_px);

  // Points outside by more than the reach are not visible.
  const Vector2 margin = Vector2::Constant(reach + 1.0) + 0.5 * smear_px.cwiseAbs();
  const Vector2 least = Vector2(region.x, region.y) - margin;
  const Vector2 most = Vector2(region.x + region.width, region.y + region.height) + margin;
  const auto is_near = [&](const ImagePoint& point) {
    return (point.pixel.array() >= least.array()).all() && (point.pixel.array() <= most.array()).all();
  };
  Vector2 low = most, high = least;
  for (const ImagePoint& point : points) {
    if (!is_near(point)) continue;
    low = low.cwiseMin(point.pixel);
    high = high.cwiseMax(point.pixel);
  }
  if (!(low.array() <= high.array()).all()) return;
  low -= 0.5 * smear_px.cwiseAbs();
  high += 0.5 * smear_px.cwiseAbs();

  const double extent = (high - low).maxCoeff();
  const double step = std::clamp(extent / 64.0, 1.0 / 64.0, 0.3 * component.sigma_px);
  const auto width = static_cast<std::size_t>((high.x() - low.x()) / step) + 2;
  const auto height = static_cast<std::size_t>((high.y() - low.y()) / step) + 2;
  grid_.assign(width * height, 0.0F);
  for (const ImagePoint& point : points) {
    if (!is_near(point)) continue;
    for (const SmearNode& node : nodes_) {
      const Vector2 place = (point.pixel + node.offset - low) / step;
      const auto i = std::min(static_cast<std::size_t>(std::max(place.x(), 0.0)), width - 2);
      const auto j = std::min(static_cast<std::size_t>(std::max(place.y(), 0.0)), height - 2);
      const double u = place.x() - static_cast<double>(i), v = place.y() - static_cast<double>(j);
      const double light = point.electrons * component.fraction * node.weight;
      float* const cell = &grid_[j * width + i];
      cell[0] += static_cast<float>(light * (1.0 - u) * (1.0 - v));
      cell[1] += static_cast<float>(light * u * (1.0 - v));
      cell[width] += static_cast<float>(light * (1.0 - u) * v);
      cell[width + 1] += static_cast<float>(light * u * v);
    }
  }

  columns_.resize(std::max(columns_.size(), width));
  for (std::size_t i = 0; i < width; ++i)
    fill(columns_[i], low.x() + step * static_cast<double>(i), reach, component.sigma_px, region.x,
         region.x + region.width);
  row_sums_.resize(static_cast<std::size_t>(region.width));
  for (std::size_t j = 0; j < height; ++j) {
    int first = region.x + region.width, last = region.x - 1;
    std::fill(row_sums_.begin(), row_sums_.end(), 0.0F);
    for (std::size_t i = 0; i < width; ++i) {
      const float light = grid_[j * width + i];
      const Profile& column = columns_[i];
      if (light == 0.0F || column.weights.empty()) continue;
      float* const sums = &row_sums_[static_cast<std::size_t>(column.first - region.x)];
      for (std::size_t k = 0; k < column.weights.size(); ++k) sums[k] += light * column.weights[k];
      first = std::min(first, column.first);
      last = std::max(last, column.first + static_cast<int>(column.weights.size()) - 1);
    }
    if (first > last) continue;
    fill(down_, low.y() + step * static_cast<double>(j), reach, component.sigma_px, region.y, region.y + region.height);
    for (std::size_t k = 0; k < down_.weights.size(); ++k) {
      float* const row = row_of(image, down_.first + static_cast<int>(k));
      for (int x = first - region.x; x <= last - region.x; ++x)
        row[x] += down_.weights[k] * row_sums_[static_cast<std::size_t>(x)];
    }
  }
}

}  // namespace vbar::twins::camera
