#pragma once
// Light of a display's pixels, as calibrated:
//   L(D) = L_full ((D - D0) / (255 - D0))^gamma for D > D0, 0 below, + L_full / contrast,
// with an L_full of each pixel, which contains the evenness of the display and the vignetting of the optics.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vbar::optical_stimulator {

// Picture of a display: a grey count for each pixel.

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> counts;  ///< rows from the top

  Picture() = default;
  Picture(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        counts(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::uint8_t& at(int x, int y) { return counts[place(x, y)]; }
  [[nodiscard]] std::uint8_t at(int x, int y) const { return counts[place(x, y)]; }
};

struct DisplayResponse {
  double gamma = 2.2;
  double first_count = 0.0;  ///< D0: above it a pixel emits light
  double contrast = 1e5;     ///< ratio of full to black
};

class DisplayLight {
 public:
  static constexpr int kFull = 255;

  /// `full_electrons`: photo-electrons that a full pixel causes in the camera in one exposure, for each pixel, rows
  /// from the top. Throws std::invalid_argument unless all numbers are finite and positive (first_count: 0 to 254) and
  /// the pixels are width x height.
  DisplayLight(const DisplayResponse& response, int width, int height, std::vector<float> full_electrons);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Returns the light of a full pixel, less the black level.
  [[nodiscard]] double full_electrons(int x, int y) const {
    return full_electrons_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x)];
  }

  /// Returns the light of a count relative to a full pixel, 0 to 1, less the black level.
  [[nodiscard]] double fraction(int count) const { return fractions_[static_cast<std::size_t>(count)]; }

  /// Returns the count whose light is nearest to that fraction, which need not lie between 0 and 1.
  [[nodiscard]] std::uint8_t nearest_count(double fraction) const;

  // Return the counts of different light next to one; the count itself if there is none.
  [[nodiscard]] int above(int count) const {
    return count < first_lit_ ? first_lit_ : count < kFull ? count + 1 : count;
  }
  [[nodiscard]] int below(int count) const { return count > first_lit_ ? count - 1 : 0; }

  /// Returns the smallest light above black, as a fraction.
  [[nodiscard]] double least_fraction() const { return fraction(first_lit_); }

  /// Returns the electrons of a pixel at black.
  [[nodiscard]] double black_electrons(int x, int y) const { return full_electrons(x, y) / contrast_; }

 private:
  int width_, height_;
  double contrast_;
  int first_lit_;
  std::array<double, kFull + 1> fractions_{};
  std::vector<float> full_electrons_;
};

// Counts of a point: as light is quantised pixel by pixel, a point's flux and centroid would err; counts chosen
// together keep both.

inline constexpr int kPatchReach = 2;
inline constexpr int kPatchSide = 2 * kPatchReach + 1;
/// Holds values, rows from the top.
template <class Value>
using Patch = std::array<Value, static_cast<std::size_t>(kPatchSide) * kPatchSide>;

/// Returns counts of the patch about the pixel (x, y), which must lie that far from the edges, for the `electrons`
/// wanted of its pixels. From the nearest counts a greedy search takes the single or paired step of one count that
/// decreases
///   (0.3 dF/F)^2 + dx^2 + dy^2
/// most, of the flux F and the centroid (x, y) of the light shown, until none does.
[[nodiscard]] Patch<std::uint8_t> matched_counts(const DisplayLight& light, int x, int y,
                                                 const Patch<double>& electrons);

}  // namespace vbar::optical_stimulator
