#pragma once
// A bright object as the camera meets it: a list of directions that light comes from.

#include "fsw/core/types.h"

namespace vbar::twins::camera {

/// Light of one small patch of sky.
struct LightSample {
  fsw::Vector3 direction_camera =
      fsw::Vector3::UnitZ();      ///< from the camera towards the patch, unit vector, camera axes
  double photons_per_m2_s = 0.0;  ///< at the lens, on an area that faces the patch (as a star's flux is counted)
};

}  // namespace vbar::twins::camera
