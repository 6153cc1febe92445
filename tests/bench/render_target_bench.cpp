// Tango by OpenGL on the processor, read back as light samples: far away (less than a pixel), at 100 m (41 pixels), and
// as wide as the picture may be.

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "host_sim/twins/camera/model/target_renderer.h"
#include "tests/support/paths.h"

namespace {

using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

void render_target(benchmark::State& state, double range_m) {
  camera::TargetRenderer renderer(camera::load_cad_model(vbar::tests::source_path("data/models/tango.obj")));
  camera::TargetView view;
  view.position_camera = Vector3(0.0, 0.0, range_m);
  view.sun_camera = Vector3(0.7, -0.5, -0.7).normalized();
  view.sun_photons_per_m2_s = 1.3e21;
  view.earth_photons_per_m2_s = 2.0e20;
  view.texel_pitch = 0.5 / 5972.7;
  std::vector<camera::LightSample> samples;
  double turn = 0.0;
  for (auto _ : state) {
    view.R_camera_body = Eigen::AngleAxisd(turn += 0.1, Vector3(0.3, 0.8, 0.5).normalized()).toRotationMatrix();
    renderer.render(view, samples);
    benchmark::DoNotOptimize(samples.data());
  }
  state.counters["texels"] = renderer.texels();
  state.counters["lit"] = static_cast<double>(samples.size());
}
BENCHMARK_CAPTURE(render_target, far, 30.0e3)
    ->Name("camera/render_target/far")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(render_target, near, 100.0)
    ->Name("camera/render_target/near")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(render_target, close, 8.0)
    ->Name("camera/render_target/close")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
