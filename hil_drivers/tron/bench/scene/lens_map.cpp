#include "hil_drivers/tron/bench/scene/lens_map.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "host_sim/twins/camera/optics.h"

namespace vbar::tron::bench {
namespace {

namespace camera = twins::camera;
using fsw::Vector2;
using fsw::Vector3;

constexpr int kStep = 8;  // px between nodes; linear in between, as the lens changes over hundreds of pixels

double solid_angle(const camera::Optics& optics, const Vector2& pixel) {
  const Vector3 across =
      optics.direction_of(pixel + Vector2(0.5, 0.0)) - optics.direction_of(pixel - Vector2(0.5, 0.0));
  const Vector3 down = optics.direction_of(pixel + Vector2(0.0, 0.5)) - optics.direction_of(pixel - Vector2(0.0, 0.5));
  return across.cross(down).norm();
}

bool same_lens(const camera::CameraSettings& a, const camera::CameraSettings& b) {
  const auto &p = a.optics, &q = b.optics;
  return p.focal_length_mm == q.focal_length_mm && p.f_number == q.f_number && p.transmission == q.transmission &&
         p.principal_point_px == q.principal_point_px && p.distortion == q.distortion && p.vignetting == q.vignetting &&
         a.detector.width == b.detector.width && a.detector.height == b.detector.height &&
         a.detector.pixel_pitch_um == b.detector.pixel_pitch_um &&
         a.detector.quantum_efficiency == b.detector.quantum_efficiency;
}

}  // namespace

LensMap::LensMap(const camera::CameraSettings& settings, const camera::Region& area)
    : settings_(settings),
      area_(area),
      map_(static_cast<std::size_t>(area.width) * static_cast<std::size_t>(area.height)) {
  const camera::Optics optics(settings);
  const int across = area.width / kStep + 2, down = area.height / kStep + 2;
  std::vector<double> nodes;
  nodes.reserve(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      const Vector2 pixel(area.x + kStep * i, area.y + kStep * j);
      nodes.push_back(solid_angle(optics, pixel) * optics.vignetting(pixel) * settings.electrons_per_photon_m2());
    }
  for (int y = 0; y < area.height; ++y)
    for (int x = 0; x < area.width; ++x) {
      const double v = static_cast<double>(y % kStep) / kStep, u = static_cast<double>(x % kStep) / kStep;
      const double* const node = &nodes[static_cast<std::size_t>(y / kStep * across + x / kStep)];
      const double top = (1.0 - u) * node[0] + u * node[1], bottom = (1.0 - u) * node[across] + u * node[across + 1];
      map_[static_cast<std::size_t>(y) * static_cast<std::size_t>(area.width) + static_cast<std::size_t>(x)] =
          static_cast<float>((1.0 - v) * top + v * bottom);
    }
}

bool LensMap::is_of(const camera::CameraSettings& settings, const camera::Region& area) const {
  return area == area_ && same_lens(settings, settings_);
}

}  // namespace vbar::tron::bench
