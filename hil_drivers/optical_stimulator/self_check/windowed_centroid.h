#pragma once
// Centroid of a dot in an image.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/types.h"

namespace vbar::optical_stimulator {

struct Spot {
  fsw::Vector2 centre{0.0, 0.0};
  double dn = 0.0;  ///< sum of the window, above the background
};

/// Returns the centroid of the light near `near`, weighted by a Gaussian of `sigma_px` about the centroid itself
/// (Bertin's windowed positions: each step is twice the weighted mean offset, as the weight halves it). `dn`: rows of
/// `width` pixels. Empty if the window does not lie on the image, or holds less than `least_dn`.
[[nodiscard]] std::optional<Spot> windowed_centroid(std::span<const std::uint16_t> dn, int width,
                                                    const fsw::Vector2& near, double background_dn, double sigma_px,
                                                    double least_dn);

}  // namespace vbar::optical_stimulator
