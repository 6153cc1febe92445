#pragma once
// Counts of a point: as light is quantised pixel by pixel, a point's flux and centroid would err; counts chosen
// together keep both.

#include <array>
#include <cstdint>

#include "hil_drivers/optical_stimulator/counts/display_light.h"

namespace vbar::optical_stimulator {

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
