#include "host_sim/twins/camera/sun_moon_discs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/photometry.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

/// Calls take(x, y) with the points of a square grid within the unit circle.
template <class Take>
void for_each_in_circle(int points_across, Take&& take) {
  for (int row = 0; row < points_across; ++row) {
    for (int column = 0; column < points_across; ++column) {
      const double x = (2.0 * column + 1.0) / points_across - 1.0;
      const double y = (2.0 * row + 1.0) / points_across - 1.0;
      if (x * x + y * y < 1.0) take(x, y);
    }
  }
}

void scale_from(std::size_t begin, double photons_per_m2_s, std::vector<LightSample>& out) {
  double sum = 0.0;
  for (std::size_t i = begin; i < out.size(); ++i) sum += out[i].photons_per_m2_s;
  for (std::size_t i = begin; i < out.size(); ++i) out[i].photons_per_m2_s *= photons_per_m2_s / sum;
}

}  // namespace

void uniform_disc(const Vector3& direction, double radius, double photons_per_m2_s, int points_across,
                  std::vector<LightSample>& out) {
  const Vector3 side = direction.unitOrthogonal();
  const Vector3 other = direction.cross(side);
  const double reach = std::tan(radius);
  const std::size_t begin = out.size();
  for_each_in_circle(points_across, [&](double x, double y) {
    out.push_back({(direction + reach * (x * side + y * other)).normalized(), 1.0});
  });
  scale_from(begin, photons_per_m2_s, out);
}

double moon_magnitude(double phase_angle, double distance_m) {
  constexpr double kMeanDistance = 3.844e8;
  constexpr double kLargest = 160.0;
  const double a = std::min(std::abs(phase_angle) * 180.0 / M_PI, kLargest);
  return -12.73 + 0.026 * a + 4e-9 * a * a * a * a + 5.0 * std::log10(distance_m / kMeanDistance);
}

void moon_disc(const Vector3& moon, const Vector3& sun_direction, double zero_magnitude_photons, int points_across,
               std::vector<LightSample>& out) {
  constexpr double kMoonColour = 0.92;  // B-V, Allen
  const double distance = moon.norm();
  const Vector3 direction = moon / distance;
  const Vector3 side = direction.unitOrthogonal();
  const Vector3 other = direction.cross(side);
  const std::size_t begin = out.size();
  for_each_in_circle(points_across, [&](double x, double y) {
    const double to_camera = std::sqrt(1.0 - x * x - y * y);  // cosine of the angle at which the surface is seen
    const Vector3 normal = x * side + y * other - to_camera * direction;
    const double to_sun = normal.dot(sun_direction);
    if (to_sun <= 0.0) return;
    out.push_back({(moon + kMoonRadiusM * normal).normalized(), to_sun / (to_sun + to_camera)});
  });
  if (out.size() == begin) return;
  const double phase_angle = std::acos(std::clamp(-direction.dot(sun_direction), -1.0, 1.0));
  scale_from(begin, star_photons(zero_magnitude_photons, moon_magnitude(phase_angle, distance), kMoonColour), out);
}

}  // namespace vbar::twins::camera
