#pragma once
// Pictures of many pixels made soft by a lens: two passes of a sampled Gaussian.

#include <vector>

namespace vbar::training {

/// Softens `picture` (rows of `width`) in place by a Gaussian of so many pixels; what it spreads beyond the edge is
/// lost. A deviation below 0.05 px changes nothing.
void soften(double sigma_px, int width, int height, std::vector<float>& picture);

}  // namespace vbar::training
