#pragma once
// The light of an extended object as a camera receives it: many points, each with direction and flux.

#include "fsw/core/types.h"

namespace vbar::twins::camera {

struct LightSample {
  fsw::Vector3 direction_camera = fsw::Vector3::UnitZ();  ///< towards it, unit
  double photons_per_m2_s = 0.0;  ///< at the lens, as CameraSettings::zero_magnitude_photons counts them
};

}  // namespace vbar::twins::camera
