#include "host_sim/twins/camera/model/shader_inputs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::twins::camera {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kEarthSteps = 512;
constexpr double kMinRoughness = 0.02;  // a mirror image of the Sun, half a degree wide, is no narrower

}  // namespace

std::array<float, 4> shader_material(const Material& m) {
  const double specular = m.grey_specular();
  const double roughness = std::clamp(std::sqrt(2.0 / (m.exponent + 2.0)), kMinRoughness, 1.0);
  return {static_cast<float>(m.grey_diffuse()), static_cast<float>(specular),
          static_cast<float>(std::min(1.0, 25.0 * specular)), static_cast<float>(roughness)};
}

double earth_factor(double cosine, double sine_earth) {
  if (cosine >= sine_earth) return cosine;
  if (cosine <= -sine_earth) return 0.0;
  const double sin2 = sine_earth * sine_earth, sine = std::sqrt(1.0 - cosine * cosine);
  const double x = std::sqrt(std::max(0.0, 1.0 / sin2 - 1.0)), y = std::clamp(-x * cosine / sine, -1.0, 1.0);
  const double s = sine * std::sqrt(1.0 - y * y);
  return std::max(0.0, ((cosine * std::acos(y) - x * s) * sin2 + std::atan2(s, x)) / (kPi * sin2));
}

std::vector<float> earth_table(double sine_earth) {
  std::vector<float> table(kEarthSteps);
  for (int i = 0; i < kEarthSteps; ++i)
    table[static_cast<std::size_t>(i)] =
        static_cast<float>(earth_factor(2.0 * i / (kEarthSteps - 1) - 1.0, sine_earth));
  return table;
}

}  // namespace vbar::twins::camera
