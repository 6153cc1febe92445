// The camera twin: an exposure's expected photo-electrons.

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>
#include <png.h>

#include "host_sim/report/plots/png.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/pixel_noise.h"
#include "host_sim/twins/camera/point_spread.h"
#include "host_sim/twins/camera/scene.h"
#include "host_sim/twins/packet_log.h"
#include "tests/support/camera_scene.h"
#include "tests/support/paths.h"

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

// The image of Tango some metres away, 800 x 500 px of a TRON-like camera binned two by two: light, detector, packets.

namespace {

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

// The detector's cost for one image of the region that is read: in the dark with a sky of stars, with stray light over
// all of it, and with the target blooming in the middle. And that of its packets: making them, and knowing them again
// when a log leaves them out.

namespace {

enum class Sky { kDark, kStrayLight, kBrightTarget };

camera::PhotonImage image_of(const camera::CameraSettings& settings, Sky sky) {
  camera::PhotonImage image{settings.region, {}};
  const int width = settings.region.width, height = settings.region.height;
  const float background = sky == Sky::kStrayLight ? 400.0F : 0.2F;
  image.electrons.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background);
  for (int star = 0; star < 150; ++star) {  // three pixels across, of 100 to 10,000 electrons
    const int x = settings.region.x + 5 + (star * 7919) % (width - 10);
    const int y = settings.region.y + 5 + (star * 104729) % (height - 10);
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) image.at(x + dx, y + dy) += 100.0F * static_cast<float>(1 + star % 100) / 9.0F;
  }
  if (sky == Sky::kBrightTarget)
    for (int dy = -20; dy <= 20; ++dy)
      for (int dx = -20; dx <= 20; ++dx)
        image.at(settings.region.x + width / 2 + dx, settings.region.y + height / 2 + dy) = 1e6F;
  return image;
}

void expose(benchmark::State& state, Sky sky) {
  const camera::CameraSettings settings;
  const camera::PhotonImage image = image_of(settings, sky);
  camera::Detector detector(settings, 1, "servicer/camera");
  std::vector<std::uint16_t> dn;
  std::int64_t number = 0;
  for (auto _ : state) {
    detector.expose(image, number++, dn);
    benchmark::DoNotOptimize(dn.data());
  }
}

BENCHMARK_CAPTURE(expose, dark, Sky::kDark)->Name("camera/detector/500x800_stars")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(expose, stray, Sky::kStrayLight)
    ->Name("camera/detector/500x800_stray_light")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(expose, target, Sky::kBrightTarget)
    ->Name("camera/detector/500x800_bright_target")
    ->Unit(benchmark::kMillisecond);

// Poisson numbers alone, in chunks of pixels, beside those of the standard library, one by one.
void poisson_numbers(benchmark::State& state, float mean) {
  camera::ChunkWords words{};
  camera::ChunkFloats means, numbers;
  means.fill(mean);
  std::uint32_t chunk = 0;
  for (auto _ : state) {
    camera::draw_words({1, 2}, camera::NoiseKind::kShot, chunk++, words);
    camera::poisson_numbers(words, means, numbers);
    benchmark::DoNotOptimize(numbers.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(camera::kChunk));
}
BENCHMARK_CAPTURE(poisson_numbers, dark, 0.3F)->Name("camera/poisson/vbar/0.3");
BENCHMARK_CAPTURE(poisson_numbers, grey, 8.0F)->Name("camera/poisson/vbar/8");
BENCHMARK_CAPTURE(poisson_numbers, bright, 400.0F)->Name("camera/poisson/vbar/400");

void poisson_numbers_of_std(benchmark::State& state, double mean) {
  std::mt19937 random(1);
  std::poisson_distribution<int> poisson(mean);
  for (auto _ : state) benchmark::DoNotOptimize(poisson(random));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(poisson_numbers_of_std, dark, 0.3)->Name("camera/poisson/std/0.3");
BENCHMARK_CAPTURE(poisson_numbers_of_std, grey, 8.0)->Name("camera/poisson/std/8");
BENCHMARK_CAPTURE(poisson_numbers_of_std, bright, 400.0)->Name("camera/poisson/std/400");

std::vector<vbar::twins::Packet> tiles_of_noise() {
  const camera::CameraSettings settings;
  std::vector<std::uint16_t> dn(500 * 800);
  for (std::size_t k = 0; k < dn.size(); ++k) dn[k] = static_cast<std::uint16_t>(64 + k * 2654435761U % 7);
  return camera::image_tiles({}, settings.region, 12, dn);
}

void make_tiles(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(tiles_of_noise());
}
BENCHMARK(make_tiles)->Name("camera/make_tiles/500x800")->Unit(benchmark::kMillisecond);

void recognise_tiles(benchmark::State& state) {
  const std::vector<vbar::twins::Packet> packets = tiles_of_noise();
  for (auto _ : state)
    for (const vbar::twins::Packet& packet : packets) benchmark::DoNotOptimize(vbar::twins::tile_run_of(packet));
}
BENCHMARK(recognise_tiles)->Name("camera/recognise_tiles/500x800")->Unit(benchmark::kMillisecond);

}  // namespace

// Tango by OpenGL on the processor, read back as light samples: far away (less than a pixel), at 100 m (41 pixels), and
// as wide as the picture may be.

namespace {

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

// Size and cost of an image in a log: JPEG-LS, as it is recorded, side by side with PNG. 500 x 800 pixels of 12 bits
// with the noise of the digital detector and 150 stars.

namespace {

const std::vector<std::uint16_t>& image() {
  static const std::vector<std::uint16_t> kImage = [] {
    const camera::CameraSettings settings;
    camera::PhotonImage photons{settings.region, {}};
    const int width = settings.region.width, height = settings.region.height;
    photons.electrons.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.2F);
    for (int star = 0; star < 150; ++star) {
      const int x = settings.region.x + 5 + (star * 7919) % (width - 10);
      const int y = settings.region.y + 5 + (star * 104729) % (height - 10);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          photons.at(x + dx, y + dy) += 100.0F * static_cast<float>(1 + star % 100) / 9.0F;
    }
    camera::Detector detector(settings, 1, "servicer/camera");
    std::vector<std::uint16_t> dn;
    detector.expose(photons, 0, dn);
    return dn;
  }();
  return kImage;
}

std::vector<std::uint8_t> recorded() {
  const camera::CameraSettings settings;
  return camera::recorded_image_of({{}, settings.region, settings.detector.bits}, image());
}

void record(benchmark::State& state) {
  static_cast<void>(image());
  for (auto _ : state) benchmark::DoNotOptimize(recorded());
  state.counters["bytes"] = static_cast<double>(recorded().size());
}
BENCHMARK(record)->Name("camera/record/jpeg_ls_500x800")->Unit(benchmark::kMillisecond);

void restore(benchmark::State& state) {
  const std::vector<std::uint8_t> bytes = recorded();
  for (auto _ : state) benchmark::DoNotOptimize(camera::pixels_of_recorded_image(bytes));
}
BENCHMARK(restore)->Name("camera/restore/jpeg_ls_500x800")->Unit(benchmark::kMillisecond);

void record_png(benchmark::State& state) {
  const camera::CameraSettings settings;
  const auto* const pixels = reinterpret_cast<const std::uint8_t*>(image().data());
  const auto png = [&] {
    return vbar::report::encoded_png(settings.region.width, settings.region.height, PNG_FORMAT_LINEAR_Y, pixels);
  };
  for (auto _ : state) benchmark::DoNotOptimize(png());
  state.counters["bytes"] = static_cast<double>(png().size());
}
BENCHMARK(record_png)->Name("camera/record/png_500x800")->Unit(benchmark::kMillisecond);

}  // namespace
