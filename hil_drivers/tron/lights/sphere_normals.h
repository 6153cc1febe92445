#pragma once
// Directions spread evenly over the sphere.

#include <vector>

#include "fsw/core/types.h"

namespace vbar::tron {

/// Returns the 162 corners of an icosahedron whose edges are divided into four, on the unit sphere.
[[nodiscard]] const std::vector<fsw::Vector3>& sphere_normals();

}  // namespace vbar::tron
