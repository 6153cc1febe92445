#pragma once
// Sums over the samples of a rendered body, and the view most tests begin with.

#include <cmath>
#include <vector>

#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::twins::camera {

struct Light {
  double flux = 0.0;                              // photons/(m^2 s)
  fsw::Vector3 direction = fsw::Vector3::Zero();  // mean, weighted with flux
};

inline Light sum_of(const std::vector<LightSample>& samples) {
  Light light;
  for (const LightSample& s : samples) {
    light.flux += s.photons_per_m2_s;
    light.direction += s.photons_per_m2_s * s.direction_camera;
  }
  if (light.flux > 0.0) light.direction /= light.flux;
  return light;
}

inline constexpr double kSunPhotons = 1.3e21;  // 1/(m^2 s), of the order of the real one

/// A body on the boresight, camera and body axes parallel, the Sun at this phase angle (Sun, body, camera) towards +x.
inline TargetView view_at(double range_m, double phase) {
  TargetView view;
  view.position_camera = fsw::Vector3(0.0, 0.0, range_m);
  view.sun_camera = fsw::Vector3(std::sin(phase), 0.0, -std::cos(phase));
  view.sun_photons_per_m2_s = kSunPhotons;
  return view;
}

}  // namespace vbar::twins::camera
