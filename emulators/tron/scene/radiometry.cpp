#include "emulators/tron/scene/radiometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::tron::bench {

namespace {

using fsw::Vector3;

double flicker(std::uint64_t seed, std::int64_t frame) {
  const engine::RandomStream stream(seed, "tron_bench/lamp_flicker");
  const double deviation = engine::normal_quantile(stream.uniforms_of(static_cast<std::uint64_t>(frame))[0]);
  return 1.0 + kFlicker * std::clamp(deviation, -4.0, 4.0);
}

// A slope and a dome, together never more than kBeamUnevenness within the beam.
std::array<double, 3> unevenness(std::uint64_t seed) {
  engine::RandomStream stream(seed, "tron_bench/lamp_beam");
  const double side = stream.uniform(0.0, 2.0 * std::numbers::pi), share = stream.uniform(0.3, 0.7);
  const double dome = stream.uniform() < 0.5 ? -1.0 : 1.0;
  const double slope = kBeamUnevenness * share;
  return {slope * std::cos(side), slope * std::sin(side), dome * kBeamUnevenness * (1.0 - share)};
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Vector3 LampBeam::direction_at(const Vector3& point_L) const {
  return (direction - inverse_distance * (point_L - centre_m)).normalized();
}

double LampBeam::irradiance_at(const Vector3& point_L) const {
  const Vector3 from_centre = point_L - centre_m;
  const double nearness = 1.0 / (direction - inverse_distance * from_centre).squaredNorm();
  if (radius_m == 0.0) return irradiance * nearness;
  const double spread = 1.0 - inverse_distance * from_centre.dot(direction);
  if (!(spread > 0.0)) return 0.0;  // behind the source
  const double u = from_centre.dot(across) / spread / radius_m, v = from_centre.dot(up) / spread / radius_m;
  const double r2 = u * u + v * v;
  const double edge = 1.0 - smooth_step(radius_m - kBeamEdgeM, radius_m + kBeamEdgeM, radius_m * std::sqrt(r2));
  return irradiance * nearness * edge * (1.0 + uneven[0] * u + uneven[1] * v + uneven[2] * r2);
}

LampBeam lamp_beam(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed, const LabView& view,
                   double sun_photons) {
  LampBeam beam;
  beam.centre_m = bench.lamp.centre_m;
  beam.direction = Lamp::direction(view.lamp.azimuth_rad);
  beam.across = Vector3::UnitZ().cross(beam.direction).normalized();
  beam.up = beam.direction.cross(beam.across);
  beam.irradiance = bench.lamp.irradiance_ratio * view.lamp.power * sun_photons;
  if (!gap.lamp) return beam;
  beam.radius_m = 0.5 * bench.lamp.beam_width_m;
  beam.inverse_distance = std::tan(kBeamDivergenceRad) / beam.radius_m;
  beam.source_radius_rad = kLampRadiusRad;
  beam.uneven = unevenness(seed);
  beam.irradiance *= flicker(seed, view.frame);
  return beam;
}

std::array<BoxLight, kBoxes> box_lights(const TestbedDesign& bench, const std::array<double, kBoxes>& powers,
                                        double sun_photons) {
  const double full = bench.boxes.exitance_ratio * bench.lamp.irradiance_ratio * sun_photons / std::numbers::pi;
  std::array<BoxLight, kBoxes> lights;
  for (std::size_t i = 0; i < kBoxes; ++i) {
    BoxLight& light = lights[i];
    light.centre_m = bench.boxes.boxes[i].centre_m;
    light.normal = bench.boxes.boxes[i].normal.normalized();
    const Vector3 upright = std::abs(light.normal.z()) < 0.9 ? Vector3::UnitZ() : Vector3::UnitX();
    light.across = upright.cross(light.normal).normalized();
    light.up = light.normal.cross(light.across);
    light.half_side_m = 0.5 * bench.boxes.side_m;
    light.radiance = full * powers[i];
  }
  return lights;
}

std::array<Emitter, 4> emitters_of(const BoxLight& box) {
  const double at = box.half_side_m / std::numbers::sqrt3;
  const double part = box.radiance * box.half_side_m * box.half_side_m;
  return {Emitter{box.centre_m + at * (box.across + box.up), box.normal, part},
          Emitter{box.centre_m + at * (box.across - box.up), box.normal, part},
          Emitter{box.centre_m - at * (box.across + box.up), box.normal, part},
          Emitter{box.centre_m - at * (box.across - box.up), box.normal, part}};
}

double irradiance_of(const BoxLight& box, const Vector3& place_m, const Vector3& normal) {
  double sum = 0.0;
  for (const Emitter& emitter : emitters_of(box)) {
    const Vector3 to = emitter.place_m - place_m;
    const double d2 = to.squaredNorm();
    if (d2 < 1e-6) continue;
    sum += emitter.radiance_area * std::max(0.0, -emitter.normal.dot(to)) * std::max(0.0, normal.dot(to)) / (d2 * d2);
  }
  return sum;
}

Vector3 light_vector(const std::array<BoxLight, kBoxes>& boxes, const Vector3& place_m) {
  Vector3 sum = Vector3::Zero();
  for (const BoxLight& box : boxes)
    for (const Emitter& emitter : emitters_of(box)) {
      const Vector3 to = emitter.place_m - place_m;
      const double d2 = to.squaredNorm();
      if (d2 < 1e-6) continue;
      sum += emitter.radiance_area * std::max(0.0, -emitter.normal.dot(to)) / (d2 * d2) * to;
    }
  return sum;
}

namespace {

namespace camera = twins::camera;
using fsw::Vector2;

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
