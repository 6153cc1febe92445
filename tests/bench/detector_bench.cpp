// The detector's cost for one image of the region that is read: in the dark with a sky of stars, with stray light over
// all of it, and with the target blooming in the middle. And that of its packets: making them, and knowing them again
// when a log leaves them out.

#include <cstdint>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/camera/pixel_noise.h"
#include "host_sim/twins/tile_run.h"

namespace {

namespace camera = vbar::twins::camera;

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
