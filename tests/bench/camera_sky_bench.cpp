// The camera twin: an exposure's expected photo-electrons.

#include <benchmark/benchmark.h>

#include "host_sim/twins/camera/scene.h"
#include "tests/support/camera_scene.h"

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

/// 500 x 800 px in the Milky Way, turning with the orbit, one spacecraft.
void render_sky(benchmark::State& state, double range) {
  camera::SceneRenderer renderer(camera::CameraSettings{}, vbar::test::camera_data());
  camera::Exposure exposure = vbar::test::quiet_exposure(Vector3(0.0, 0.8, -0.6));
  exposure.rate_camera = Vector3(1.06e-3, 0.0, 0.0);
  exposure.objects.push_back(vbar::test::object_at(exposure, Vector3(0.01, 0.02, 1.0) * range));
  camera::PhotonImage image;
  for (auto _ : state) {
    renderer.render(exposure, image);
    benchmark::DoNotOptimize(image.electrons.data());
  }
}
BENCHMARK_CAPTURE(render_sky, far, 75e3)->Name("camera/render_sky/500x800")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_sky, near, 100.0)->Name("camera/render_sky/500x800_near")->Unit(benchmark::kMillisecond);

/// The Earth's day side over half of the image.
void render_earth(benchmark::State& state) {
  camera::SceneRenderer renderer(camera::CameraSettings{}, vbar::test::camera_data());
  camera::Exposure exposure = vbar::test::quiet_exposure(Vector3(0.0, 1.0, 0.0));
  exposure.camera_position_eci = Vector3(7.0e6, 0.0, 0.0);
  exposure.q_camera_eci = vbar::test::camera_attitude(Vector3(-0.911, 0.412, 0.0), -Vector3::UnitX());
  camera::PhotonImage image;
  for (auto _ : state) {
    renderer.render(exposure, image);
    benchmark::DoNotOptimize(image.electrons.data());
  }
}
BENCHMARK(render_earth)->Name("camera/render_sky/500x800_earth")->Unit(benchmark::kMillisecond);

void load_sky(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(
        camera::StarSky::load(vbar::test::camera_data() / "stars/hipparcos_v8.csv", 3.1e10).stars().size());
}
BENCHMARK(load_sky)->Name("camera/load_sky/all")->Unit(benchmark::kMillisecond);

}  // namespace
