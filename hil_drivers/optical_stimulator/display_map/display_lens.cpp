#include "hil_drivers/optical_stimulator/display_map/display_lens.h"

namespace vbar::optical_stimulator {

std::array<double, LensTerms::kCount> LensTerms::values() const {
  return {centre_px[0],  centre_px[1],  scale_px,      rotation_rad,  tilt_rad[0],  tilt_rad[1],
          distortion[0], distortion[1], distortion[2], distortion[3], distortion[4]};
}

LensTerms LensTerms::of(const std::array<double, kCount>& values) {
  LensTerms lens;
  lens.centre_px = {values[0], values[1]};
  lens.scale_px = values[2];
  lens.rotation_rad = values[3];
  lens.tilt_rad = {values[4], values[5]};
  lens.distortion = {values[6], values[7], values[8], values[9], values[10]};
  return lens;
}

}  // namespace vbar::optical_stimulator
