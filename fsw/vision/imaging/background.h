#pragma once
// Background of an image: level and noise on a coarse grid, interpolated between, by the method of
// SExtractor (Bertin and Arnouts 1996, section 3.2): clipped statistics of cells; a cell that is filled by an object
// is assigned the value of its neighbours. The noise is that of differences of neighbouring pixels, which gradients of
// stray light do not affect.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/vision/imaging/image.h"

namespace vbar::fsw::imaging {

// Robust mean and standard deviation of many integers with outliers: those of a Gaussian, from a histogram.

struct ClippedMoments {
  double mean = 0.0;
  double sigma = 0.0;
};

/// Returns the moments within 3 sigma of the mean, found by iteration from median and quartiles; the sigma is that of
/// the whole Gaussian, corrected for the clipped tails. `counts[k]` samples have the value k; `total` is their sum and
/// at least 1. The sigma is accurate to half a per cent; below 0.9, where clipping at integers is coarse, to two or
/// three.
ClippedMoments clipped_moments(std::span<const std::uint16_t> counts, int total);

/// Condition of an image for evaluation.
enum class ImageCondition : std::uint8_t {
  kGood = 0,
  kBlank,      ///< all pixels are equal: not the output of a detector, which has noise
  kSaturated,  ///< nearly all pixels are saturated
  kTooLittle,  ///< nearly all pixels are missing
  kInvalid,    ///< not a valid image: sides and number of pixels disagree, or invalid settings
};

class Background {
 public:
  /// A quantity along one row of the image, DN / 256, at the nodes of the grid.
  using RowNodes = std::array<int, 68>;
  static constexpr int kMaxNoises = 100 * 16;

  /// Measures level and noise of the image. Saturated pixels (`saturation_dn`, 1 to 4095, and above) and missing ones
  /// are excluded. The functions below refer to the last image that was kGood.
  [[nodiscard]] ImageCondition measure(const ImageView& image, int saturation_dn);

  /// Computes the level along row y.
  void level_row(int y, RowNodes& nodes) const;
  /// Computes the detection threshold of the sum of nine pixels along row y: nine levels, noises_q4 / 16 times the
  /// noise (1 sigma) of one pixel, at most kMaxNoises, and the uncertainty of the level between nodes.
  void threshold_row(int y, int noises_q4, RowNodes& nodes) const;
  /// Returns either quantity at pixel x of the row, DN / 256, rounded down.
  [[nodiscard]] int at(const RowNodes& nodes, int x) const;
  /// Writes either quantity at every pixel of the row, DN, rounded down.
  void fill(const RowNodes& nodes, std::span<int> out_dn) const;

  /// Returns level and 1 sigma at a pixel, DN.
  [[nodiscard]] double level_dn(int x, int y) const;
  [[nodiscard]] double noise_dn(int x, int y) const;

  /// Medians over the image, DN.
  [[nodiscard]] double typical_level_dn() const { return typical_level_dn_; }
  [[nodiscard]] double typical_noise_dn() const { return typical_noise_dn_; }
  /// Number of pixels evaluated (a quarter of the image), and of those that are saturated or missing.
  [[nodiscard]] int sampled() const { return sampled_; }
  [[nodiscard]] int saturated() const { return saturated_; }
  [[nodiscard]] int missing() const { return missing_; }

 private:
  static constexpr int kCell = 64;  ///< px, about
  /// Along one axis: number of cells, a node in the middle of each and one beyond either end.
  struct Axis {
    int pixels = 0;
    int cells = 0;
    int step = 0;  ///< nodes a pixel, 2^-20
    [[nodiscard]] int first_pixel(int cell) const { return cell * pixels / cells; }
    [[nodiscard]] int position(int pixel) const { return (2 * pixel + 1) * step / 2 + (1 << 19); }
  };
  static constexpr std::size_t kMaxNodes = 288;  ///< (w / 64 + 2.5) (h / 64 + 2.5) within kMaxPixels and kMaxSide
  using Grid = std::array<int, kMaxNodes>;

  [[nodiscard]] static Axis axis_of(int pixels);
  [[nodiscard]] std::size_t node(int column, int row) const {  ///< node of a cell; -1 and `cells` are beyond the ends
    const int k = (row + 1) * (x_.cells + 2) + column + 1;
    return static_cast<std::size_t>(k);
  }
  [[nodiscard]] ImageCondition measure_cells(const ImageView& image, int saturation_dn);
  void count_cell(const ImageView& image, int saturation_dn, int column, int row);
  void measure_cell(int column, int row);
  [[nodiscard]] bool fill_gaps();
  [[nodiscard]] bool fill_gap(int column, int row);
  void replace_outliers();
  [[nodiscard]] int agreed_level(int column, int row) const;
  void find_level_uncertainty();
  template <class Beyond>
  void extend(Grid& grid, Beyond beyond) const;
  template <class At>
  void set_row(int y, RowNodes& nodes, At at_node) const;
  void find_typical();

  Axis x_;
  Axis y_;
  std::array<std::int16_t, 68> segment_begin_{};  ///< the first pixel of a row that lies beyond node k
  Grid level_{};                                  ///< DN / 256
  Grid noise_{};                                  ///< 1 sigma of a pixel, DN / 256
  Grid level_uncertainty_{};                      ///< uncertainty of the level between nodes, DN / 256
  Grid scratch_{};
  std::array<bool, kMaxNodes> is_known_{};
  double typical_level_dn_ = 0.0;
  double typical_noise_dn_ = 0.0;

  // Statistics of the cell in work
  static constexpr std::size_t kLevels = 4096;
  static constexpr int kMaxDifference = 511;
  std::array<std::uint16_t, kLevels> level_count_{};
  std::array<std::uint16_t, 2 * kMaxDifference + 1> difference_count_{};
  int levels_ = 0;       ///< pixels counted
  int differences_ = 0;  ///< pairs counted
  int lowest_ = 0;       ///< level
  int highest_ = 0;
  // Statistics of the image
  int sampled_ = 0;
  int saturated_ = 0;
  int missing_ = 0;
  int darkest_ = 0;
  int brightest_ = 0;
};

}  // namespace vbar::fsw::imaging
