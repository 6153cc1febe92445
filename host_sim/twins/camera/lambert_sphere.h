#pragma once
// The simplest spacecraft model: a Lambert sphere. Its light is known in closed form.

#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// Renders every model as a Lambert sphere of `radius_m` and `albedo` in the Sun's light alone, by `points_across`
/// points over its disc. At a distance its flux is that of the sunlight times (2/3) albedo (radius/distance)^2 (sin a +
/// (pi - a) cos a)/pi at the phase angle a (Russell 1916).
ObjectRenderer lambert_sphere(double radius_m, double albedo, int points_across = 96);

}  // namespace vbar::twins::camera
