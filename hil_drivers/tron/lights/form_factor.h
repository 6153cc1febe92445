#pragma once
// Irradiance by an even Lambert surface in the shape of a polygon.

#include <span>

#include "fsw/core/types.h"

namespace vbar::tron {

/// Returns the irradiance of an area at `point` that faces `normal` (unit), relative to the radiant exitance of the
/// polygon: the contour integral of Lambert over the part above the area's horizon (Baum, Rushmeier, Winget 1989,
/// "Improving radiosity solutions through the use of analytically determined form-factors"). `corners`: a convex
/// polygon in a plane, anticlockwise as seen from its bright side; its other side gives 0. A point in its plane gives
/// 0.
[[nodiscard]] double form_factor(const fsw::Vector3& point, const fsw::Vector3& normal,
                                 std::span<const fsw::Vector3> corners);

}  // namespace vbar::tron
