// The image of Tango some metres away, 800 x 500 px of a TRON-like camera binned two by two: light, detector, packets.

#include <cstdint>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "host_sim/twins/camera/binning.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/point_spread.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/camera_scene.h"

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

camera::CameraSettings close_camera() {
  camera::CameraSettings single;
  single.optics.focal_length_mm = 17.0;
  single.optics.f_number = 4.0;
  single.optics.distortion = {-0.22383, 0.514098, -0.000664997, -0.000214048, -0.131243};
  single.optics.point_spread_sigma_px = 0.6;
  single.exposure_s = 2e-4;
  camera::CameraSettings settings = camera::binned(single, 2);
  settings.region = {80, 50, 800, 500};
  return settings;
}

camera::Exposure exposure_of_tango(double range_m) {
  camera::Exposure exposure = vbar::test::quiet_exposure(Vector3(0.0, 0.8, -0.6));
  exposure.rate_camera = Vector3(1.06e-3, 0.0, 0.0);
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(0.01, 0.02, 1.0) * range_m));
  exposure.objects[0].model = "tango";
  return exposure;
}

const camera::CadSources kTango{{"tango", {.file = vbar::test::camera_data() / "models/tango.obj"}}};

void turn(camera::Exposure& exposure, int image) {
  exposure.objects[0].q_body_eci = Eigen::AngleAxisd(0.1 * image, Vector3(0.3, 0.8, 0.5).normalized());
}

void render(benchmark::State& state, double range_m) {
  camera::SceneRenderer renderer(close_camera(), vbar::test::camera_data(), camera::cad_objects(kTango));
  camera::Exposure exposure = exposure_of_tango(range_m);
  camera::PhotonImage image;
  int number = 0;
  for (auto _ : state) {
    turn(exposure, ++number);
    renderer.render(exposure, image);
    benchmark::DoNotOptimize(image.electrons.data());
  }
}
BENCHMARK_CAPTURE(render, at_5_m, 5.0)->Name("camera/render_close/5")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render, at_7_m, 7.0)->Name("camera/render_close/7")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render, at_13_m, 13.0)->Name("camera/render_close/13")->Unit(benchmark::kMillisecond);

/// The drawing alone.
void draw(benchmark::State& state, double range_m) {
  const camera::ObjectRenderer objects = camera::cad_objects(kTango);
  camera::ObjectView view;
  view.model = "tango";
  view.position_camera = Vector3(0.01, 0.02, 1.0) * range_m;
  view.sun_direction_camera = Vector3(0.7, -0.5, -0.7).normalized();
  view.sun_photons_per_m2_s = 1.3e21;
  view.earth_photons_per_m2_s = 2.0e20;
  view.pixel_rad = 1.0 / close_camera().focal_length_px();
  std::vector<camera::LightSample> samples;
  int image = 0;
  for (auto _ : state) {
    view.R_camera_body = Eigen::AngleAxisd(0.1 * ++image, Vector3(0.3, 0.8, 0.5).normalized()).toRotationMatrix();
    samples.clear();
    objects(view, samples);
    benchmark::DoNotOptimize(samples.data());
  }
  state.counters["lit"] = static_cast<double>(samples.size());
}
BENCHMARK_CAPTURE(draw, at_5_m, 5.0)
    ->Name("camera/draw_close/5")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(draw, at_7_m, 7.0)
    ->Name("camera/draw_close/7")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(draw, at_13_m, 13.0)
    ->Name("camera/draw_close/13")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

/// The spread alone, of as many samples as the drawing gives.
void spread(benchmark::State& state, double range_m) {
  const camera::CameraSettings settings = close_camera();
  const camera::ObjectRenderer objects = camera::cad_objects(kTango);
  camera::ObjectView view;
  view.model = "tango";
  view.position_camera = Vector3(0.0, 0.0, range_m);
  view.sun_direction_camera = Vector3(0.7, -0.5, -0.7).normalized();
  view.sun_photons_per_m2_s = 1.3e21;
  view.pixel_rad = 1.0 / settings.focal_length_px();
  std::vector<camera::LightSample> samples;
  objects(view, samples);
  std::vector<camera::ImagePoint> points;
  const camera::Optics optics(settings);
  for (const camera::LightSample& sample : samples)
    points.push_back({*optics.project(sample.direction_camera), 1e-10 * sample.photons_per_m2_s});
  camera::PhotonImage image{settings.region, std::vector<float>(800 * 500, 0.0F)};
  camera::PointSpread point_spread(settings.optics);
  for (auto _ : state) {
    point_spread.add(points, vbar::fsw::Vector2(0.01, 0.0), image);
    benchmark::DoNotOptimize(image.electrons.data());
  }
  state.counters["points"] = static_cast<double>(points.size());
}
BENCHMARK_CAPTURE(spread, at_5_m, 5.0)->Name("camera/spread_close/5")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(spread, at_13_m, 13.0)->Name("camera/spread_close/13")->Unit(benchmark::kMillisecond);

/// Detector and packets after the light.
void read_out(benchmark::State& state) {
  const camera::CameraSettings settings = close_camera();
  camera::SceneRenderer renderer(settings, vbar::test::camera_data(), camera::cad_objects(kTango));
  camera::Exposure exposure = exposure_of_tango(7.0);
  turn(exposure, 3);
  camera::PhotonImage image;
  renderer.render(exposure, image);
  camera::Detector detector(settings, 1, "servicer/camera");
  std::vector<std::uint16_t> dn;
  std::int64_t number = 0;
  for (auto _ : state) {
    detector.expose(image, number++, dn);
    benchmark::DoNotOptimize(camera::image_tiles({}, settings.region, 12, dn));
  }
}
BENCHMARK(read_out)->Name("camera/read_out_close/7")->Unit(benchmark::kMillisecond);

}  // namespace
