#pragma once
// Robust mean and standard deviation of many integers with outliers: those of a Gaussian, from a histogram.

#include <cstdint>
#include <span>

namespace vbar::fsw::imaging {

struct ClippedMoments {
  double mean = 0.0;
  double sigma = 0.0;
};

/// Returns the moments within 3 sigma of the mean, found by iteration from median and quartiles; the sigma is that of
/// the whole Gaussian, corrected for the clipped tails. `counts[k]` samples have the value k; `total` is their sum and
/// at least 1. The sigma is accurate to half a per cent; below 0.9, where clipping at integers is coarse, to two or
/// three.
ClippedMoments clipped_moments(std::span<const std::uint16_t> counts, int total);

}  // namespace vbar::fsw::imaging
