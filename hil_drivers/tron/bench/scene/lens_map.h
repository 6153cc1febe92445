#pragma once
// Conversion of radiance to photo-electrons, pixel by pixel: solid angle of a pixel (distortion included) times
// transmission.

#include <vector>

#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

class LensMap {
 public:
  /// Computes the map of `area` of the detector; `area` may reach beyond the detector.
  LensMap(const twins::camera::CameraSettings& settings, const twins::camera::Region& area);

  [[nodiscard]] bool is_of(const twins::camera::CameraSettings& settings, const twins::camera::Region& area) const;
  /// Returns photo-electrons a second per unit of radiance, photons/(m^2 s sr); rows from the top.
  [[nodiscard]] const std::vector<float>& electrons_per_radiance() const { return map_; }

 private:
  twins::camera::CameraSettings settings_;
  twins::camera::Region area_;
  std::vector<float> map_;
};

}  // namespace vbar::tron::bench
