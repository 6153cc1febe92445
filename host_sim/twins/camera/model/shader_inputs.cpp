#include "host_sim/twins/camera/model/shader_inputs.h"

#include <algorithm>
#include <cmath>

#include "host_sim/twins/camera/earth_light.h"

namespace vbar::twins::camera {
namespace {

constexpr int kEarthSteps = 512;
constexpr double kMinRoughness = 0.02;  // a mirror image of the Sun, half a degree wide, is no narrower

}  // namespace

std::array<float, 4> shader_material(const Material& m) {
  const double specular = m.grey_specular();
  const double roughness = std::clamp(std::sqrt(2.0 / (m.exponent + 2.0)), kMinRoughness, 1.0);
  return {static_cast<float>(m.grey_diffuse()), static_cast<float>(specular),
          static_cast<float>(std::min(1.0, 25.0 * specular)), static_cast<float>(roughness)};
}

std::vector<float> earth_table(double sine_earth) {
  std::vector<float> table(kEarthSteps);
  for (int i = 0; i < kEarthSteps; ++i)
    table[static_cast<std::size_t>(i)] =
        static_cast<float>(earth_light_factor(2.0 * i / (kEarthSteps - 1) - 1.0, sine_earth));
  return table;
}

}  // namespace vbar::twins::camera
