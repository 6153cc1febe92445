#pragma once
// Light of a point in the pixels of a row: a Gaussian, integrated over the width of each pixel.

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace vbar::optical_stimulator::bench {

/// Spreads the light of a point with one width. The sum over the pixels is 1, and the centroid is the place, for every
/// place.
class SpreadProfile {
 public:
  explicit SpreadProfile(double sigma_px);

  /// Returns the number of pixels before and behind the nearest one.
  [[nodiscard]] int radius() const { return radius_; }
  /// Computes the weights of the 2 radius + 1 pixels for a point that is `offset` (-0.5 to 0.5) behind the centre of
  /// the middle one; offsets up to 1 are accepted.
  void weights(double offset, std::span<float> weights) const;

 private:
  int radius_;
  std::size_t stride_;
  std::vector<float> table_;
};

/// Holds the profiles of all widths, to 0.01 px, made when they are first asked for.
class SpreadProfiles {
 public:
  SpreadProfiles();
  /// Returns the profile of a width; widths beyond the widest count as the widest.
  [[nodiscard]] std::size_t index_of(double sigma_px) const;
  [[nodiscard]] const SpreadProfile& at(std::size_t index);

  static constexpr double kStep_px = 0.01;
  static constexpr double kWidest_px = 15.0;

 private:
  std::vector<const SpreadProfile*> known_;
  std::deque<SpreadProfile> profiles_;
};

}  // namespace vbar::optical_stimulator::bench
