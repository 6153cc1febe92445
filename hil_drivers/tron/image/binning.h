#pragma once
// Binning in the driver, for a camera that reads single pixels.

#include <cstdint>
#include <span>
#include <vector>

namespace vbar::tron {

/// Returns means of 2 x 2 pixels, halves rounded up: the numbers of a camera that adds the charges of four pixels and
/// reads a full sum as it does a full pixel (twins/camera/binning.h). `dn`: rows of `width`; width and height are even.
/// Throws std::invalid_argument for another size.
[[nodiscard]] std::vector<std::uint16_t> binned_by_two(std::span<const std::uint16_t> dn, int width, int height);

}  // namespace vbar::tron
