#pragma once
// The default bench with its parts, and frames to show on it.

#include <cstdint>
#include <memory>
#include <vector>

#include "emulators/optical_stimulator/light_path.h"
#include "emulators/optical_stimulator/screen.h"
#include "emulators/optical_stimulator/settings.h"
#include "host_sim/mission/data_file.h"
#include "tests/support/paths.h"

namespace vbar::optical_stimulator::bench::test {

inline BenchSettings default_bench(const std::vector<std::string>& assignments = {}) {
  return read_bench(mission::data_directory() / "benches/optical_stimulator.toml", assignments);
}

/// Without what differs from bench to bench: no errors of place and light.
inline BenchSettings perfect_bench() {
  BenchSettings bench = default_bench();
  bench.pose = {bench.pose.pitch_um, {0.0, 0.0}, 0.0, {0.0, 0.0}};
  bench.optics.distortion = {};
  bench.optics.coma_px = 0.0;
  bench.field.direction_arcsec = 0.0;
  bench.field.light = 0.0;
  bench.light.pixel_unevenness = 0.0;
  bench.drift = {0, 0.0, 0.0, 0.0, 0.0, 2159};
  bench.noise = false;
  bench.camera.offset_dn = 0.0;
  return bench;
}

/// Optics and light of a bench.
struct Light {
  explicit Light(const BenchSettings& bench)
      : camera(camera_of(bench, mission::data_directory())),
        field(bench.field, bench.seed, bench.display.width, bench.display.height),
        optics(bench.lenses, bench.pose, bench.optics, field, camera, bench.display.width, bench.display.height),
        path({bench.display.width, bench.display.height, bench.light, camera, bench.seed}, optics) {}

  twins::camera::PhotonImage expose(const std::vector<std::uint8_t>& counts, const twins::camera::Region& region,
                                    double exposure_s = 0.2) {
    twins::camera::PhotonImage image{region, {}};
    const ShownFrame frame{counts, 1.0};
    path.expose({&frame, 1}, exposure_s, 1.0, image);
    return image;
  }

  twins::camera::CameraSettings camera;
  ErrorField field;
  BenchOptics optics;
  LightPath path;
};

struct Frame {
  explicit Frame(const BenchSettings& bench) : width(bench.display.width), height(bench.display.height) {
    counts.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  }
  std::uint8_t& at(int u, int v) {
    return counts[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
  }
  int width, height;
  std::vector<std::uint8_t> counts;
};

struct Moments {
  double sum = 0.0, x = 0.0, y = 0.0;
};

inline Moments moments_of(const twins::camera::PhotonImage& image, double background = 0.0) {
  Moments m;
  std::size_t k = 0;
  for (int y = image.region.y; y < image.region.y + image.region.height; ++y) {
    for (int x = image.region.x; x < image.region.x + image.region.width; ++x, ++k) {
      const double light = static_cast<double>(image.electrons[k]) - background;
      m.sum += light;
      m.x += light * x;
      m.y += light * y;
    }
  }
  m.x /= m.sum;
  m.y /= m.sum;
  return m;
}

}  // namespace vbar::optical_stimulator::bench::test
