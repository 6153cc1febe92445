#pragma once
// Blur of an image by a lens: two passes of a sampled Gaussian.

#include <vector>

namespace vbar::training {

/// Blurs `picture` (rows of `width`) in place by a Gaussian with this standard deviation in pixels; light beyond the
/// edge is lost. A deviation below 0.05 px changes nothing.
void soften(double sigma_px, int width, int height, std::vector<float>& picture);

}  // namespace vbar::training
