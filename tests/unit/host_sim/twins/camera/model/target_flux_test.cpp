// Light of plates and spheres against formulas.

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/unit/host_sim/twins/camera/model/shapes.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

constexpr double kPi = std::numbers::pi;
constexpr double kSun = 1.3e21;  // photons/(m^2 s), of the order of the real one

struct Light {
  double flux = 0.0;
  Vector3 centroid = Vector3::Zero();  // mean direction, weighted with flux
};

Light sum_of(const std::vector<LightSample>& samples) {
  Light light;
  for (const LightSample& s : samples) {
    light.flux += s.photons_per_m2_s;
    light.centroid += s.photons_per_m2_s * s.direction_camera;
  }
  light.centroid /= light.flux;
  return light;
}

// On the boresight, the Sun at this phase angle (Sun, body, camera) towards +x.
TargetView view_at(double range_m, double phase) {
  TargetView view;
  view.position_camera = Vector3(0.0, 0.0, range_m);
  view.sun_camera = Vector3(std::sin(phase), 0.0, -std::cos(phase));
  view.sun_photons_per_m2_s = kSun;
  return view;
}

TEST(TargetFlux, OfALambertSphereIsTheHandFormulas) {
  // Flux = E albedo (R/d)^2 2/(3 pi) ((pi - a) cos a + sin a) at phase angle a; its centroid lies
  // R (3 pi/16) sin a (1 + cos a) / ((pi - a) cos a + sin a) from the middle towards the Sun: integrals of
  // mu mu0 over the lit and visible lune.
  std::vector<Triangle> triangles;
  const double radius = 0.35, albedo = 0.3;
  shapes::add_sphere(triangles, Vector3::Zero(), radius, 48);
  TargetRenderer renderer(shapes::model_of(triangles, shapes::lambert(albedo)));
  std::vector<LightSample> samples;
  for (const double range : {200.0, 5.0e3, 75.0e3})
    for (const double phase : {0.0, 0.5 * kPi, 0.75 * kPi}) {
      renderer.render(view_at(range, phase), samples);
      const Light light = sum_of(samples);
      const double lune = (kPi - phase) * std::cos(phase) + std::sin(phase);
      const double expected = kSun * albedo * std::pow(radius / range, 2) * 2.0 / (3.0 * kPi) * lune;
      EXPECT_NEAR(light.flux / expected, 1.0, 0.02) << range << " m, phase " << phase;
      const double offset = radius * 3.0 * kPi / 16.0 * std::sin(phase) * (1.0 + std::cos(phase)) / lune;
      EXPECT_NEAR(light.centroid.x() * range, offset, 0.02 * radius) << range << " m, phase " << phase;
      EXPECT_NEAR(light.centroid.y() * range, 0.0, 0.005 * radius);
      std::printf("%g %g: %.5f  %.5f %.5f\n", range, phase, light.flux / expected, light.centroid.x() * range, offset);
    }
}

}  // namespace
}  // namespace vbar::twins::camera
