#pragma once
// Charge beyond the full well of a pixel.

#include <vector>

namespace vbar::twins::camera {

struct BloomingSettings {
  double full_well_electrons = 0.0;
  double spilled_fraction =
      0.0;  ///< share of the charge beyond the full well that spills to the four neighbours; the rest is drained
};

/// Spills and drains what exceeds the full well in `charge` (rows of `width`, electrons), in rounds, each of all pixels
/// at once, so that no direction is preferred: a quarter of what spills goes to each neighbour, over the image's edge
/// it is lost. Afterwards no pixel holds more than the full well. The rounds end when no pixel exceeds it;
/// after kBloomingRounds the excess is drained. Returns the electrons drained or lost: these and those kept add up to
/// the input.
double bloom(const BloomingSettings& settings, int width, int height, std::vector<float>& charge);

inline constexpr int kBloomingRounds = 200;

}  // namespace vbar::twins::camera
