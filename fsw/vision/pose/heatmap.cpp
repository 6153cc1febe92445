#include "fsw/vision/pose/heatmap.h"

#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::pose {
namespace {

using Logits = std::span<const float, pose::kMapCells>;

constexpr int kSide = pose::kMapSide;
constexpr int kReach = 3;  ///< cells of the window on either side of its centre
constexpr double kMaxSecond = 0.6;
/// exp(-40) of the maximum: 1024 of them are negligible.
constexpr double kNegligible = -40.0;

struct Cell {
  int column = 0;
  int row = 0;
};

/// The part of a square of cells that lies on the heatmap.
struct Window {
  int left, right, top, bottom;

  Window(const Cell& middle, int reach)
      : left(middle.column > reach ? middle.column - reach : 0),
        right(middle.column + reach < kSide ? middle.column + reach : kSide - 1),
        top(middle.row > reach ? middle.row - reach : 0),
        bottom(middle.row + reach < kSide ? middle.row + reach : kSide - 1) {}

  [[nodiscard]] bool holds(int column, int row) const {
    return column >= left && column <= right && row >= top && row <= bottom;
  }
};

/// The heatmap's probabilities relative to that of its highest cell.
class Likelihood {
 public:
  Likelihood(Logits logits, float highest) : logits_(logits), highest_(static_cast<double>(highest)) {}

  [[nodiscard]] double at(int column, int row) const {
    const double below = static_cast<double>(logits_[static_cast<std::size_t>(row * kSide + column)]) - highest_;
    return below > kNegligible ? math::exp(below) : 0.0;
  }

  [[nodiscard]] double sum(const Window& window) const {
    double sum = 0.0;
    for (int row = window.top; row <= window.bottom; ++row) {
      for (int column = window.left; column <= window.right; ++column) sum += at(column, row);
    }
    return sum;
  }

 private:
  Logits logits_;
  double highest_;
};

/// In cells, within a window.
struct Moments {
  Vector2 mean = Vector2::Zero();
  Matrix2 second = Matrix2::Zero();  ///< about the mean
};

Moments moments_of(const Likelihood& map, const Window& window) {
  double sum = 0.0;
  Vector2 first = Vector2::Zero();
  Matrix2 second = Matrix2::Zero();
  // From the window's corner, to avoid cancellation.
  for (int row = window.top; row <= window.bottom; ++row) {
    for (int column = window.left; column <= window.right; ++column) {
      const double weight = map.at(column, row);
      const Vector2 place(column - window.left, row - window.top);
      sum += weight;
      first += weight * place;
      second += weight * place * place.transpose();
    }
  }
  const Vector2 mean = first / sum;
  return {mean + Vector2(window.left, window.top), second / sum - mean * mean.transpose()};
}

/// Moments of a Gaussian at `centre` in the cells `first` to `last` of one axis.
struct CutGaussian {
  double mean = 0.0;
  double variance = 0.0;
};
CutGaussian cut_gaussian(double centre, double sigma, int first, int last) {
  double sum = 0.0;
  double one = 0.0;
  double two = 0.0;
  for (int cell = first; cell <= last; ++cell) {
    const double off = cell - centre;
    const double weight = math::exp(-0.5 * off * off / (sigma * sigma));
    sum += weight;
    one += weight * off;
    two += weight * off * off;
  }
  const double mean = one / sum;
  return {centre + mean, two / sum - mean * mean};
}

/// Replaces the mean of one axis by the centre of the Gaussian that has this mean in the window, and subtracts that
/// Gaussian's variance.
void allow_for_cut(double sigma, int first, int last, double& mean, double& variance) {
  double centre = mean;
  CutGaussian cut = cut_gaussian(centre, sigma, first, last);
  constexpr double kMinSlope = 0.3;  // derivative of the truncated mean with respect to the centre; 0.5 at the edge
  for (int k = 0; k < 4; ++k) {
    const double slope = cut.variance / (sigma * sigma);
    centre += (mean - cut.mean) / (slope > kMinSlope ? slope : kMinSlope);
    cut = cut_gaussian(centre, sigma, first, last);
  }
  mean = centre;
  variance -= cut.variance;
}

/// The cell of a position; positions are within the heatmap.
Cell cell_of(const Vector2& place) {
  return {static_cast<int>(place.x() + 0.5), static_cast<int>(place.y() + 0.5)};
}

}  // namespace

MapPeak read_map(Logits logits, double target_sigma_cells) {
  MapPeak peak;
  peak.is_at_border = true;
  std::size_t highest = 0;
  for (std::size_t k = 0; k < logits.size(); ++k) {
    if (!math::is_finite(static_cast<double>(logits[k]))) return peak;
    if (logits[k] > logits[highest]) highest = k;
  }
  const Likelihood map(logits, logits[highest]);
  const Cell top{static_cast<int>(highest % kSide), static_cast<int>(highest / kSide)};
  peak.is_at_border = top.column == 0 || top.row == 0 || top.column == kSide - 1 || top.row == kSide - 1;

  const Window around(top, kReach);
  double total = 0.0;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const double here = map.at(column, row);
      total += here;
      if (!around.holds(column, row) && here > peak.second) peak.second = here;
    }
  }
  peak.peak = map.sum(Window(top, 1)) / total;
  // Repeated around the mean: a window that truncates one side of the peak more than the other biases the mean.
  const Window window(cell_of(moments_of(map, around).mean), kReach);
  const Moments moments = moments_of(map, window);
  peak.place = moments.mean;
  peak.excess = moments.second;
  allow_for_cut(target_sigma_cells, window.left, window.right, peak.place.x(), peak.excess(0, 0));
  allow_for_cut(target_sigma_cells, window.top, window.bottom, peak.place.y(), peak.excess(1, 1));
  return peak;
}

Matrix2 place_covariance(const MapPeak& peak, const pose::Calibration& calibration) {
  Matrix2 covariance = static_cast<double>(calibration.covariance_floor) * Matrix2::Identity();
  const Result<math::SymmetricEigen<2>> eigen = math::symmetric_eigen<2>(peak.excess);
  if (!eigen.ok()) return covariance;
  for (int k = 0; k < 2; ++k) {
    const double value = eigen.value().values(k);
    if (value <= 0.0) continue;
    const Vector2 axis = eigen.value().vectors.col(k);
    covariance += static_cast<double>(calibration.covariance_scale) * value * axis * axis.transpose();
  }
  return covariance;
}

Keypoint keypoint_of(const MapPeak& peak, const pose::Calibration& calibration, const CropRegion& region) {
  const double cell_px = region.side_px / kSide;
  Keypoint keypoint;
  const Vector2 middle = Vector2::Constant(0.5 * (kSide - 1));
  const Vector2 place = middle + (1.0 + static_cast<double>(calibration.stretch)) * (peak.place - middle);
  keypoint.pixel = region.pixel_of(place, kSide);
  keypoint.covariance_px2 = cell_px * cell_px * place_covariance(peak, calibration);
  keypoint.peak = peak.peak;
  keypoint.is_usable =
      !peak.is_at_border && peak.peak >= static_cast<double>(calibration.least_peak) && peak.second <= kMaxSecond;
  return keypoint;
}

}  // namespace vbar::fsw::pose
