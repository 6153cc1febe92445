// What an image of the reference camera's region costs: out of its tiles, and into objects.

#include <memory>

#include <benchmark/benchmark.h>

#include "fsw/imaging/image_assembly.h"
#include "fsw/imaging/object_detector.h"
#include "fsw/imaging/tile_packing.h"
#include "tests/support/synthetic_image.h"

namespace {

using namespace vbar::fsw::imaging;

constexpr int kWidth = 500;
constexpr int kHeight = 800;

/// So many stars of magnitude 7.5 and brighter, smeared as by the orbit's rate.
std::vector<std::uint16_t> star_field(int stars) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  vbar::test::SyntheticImage scene(kWidth, kHeight);
  for (int k = 0; k < stars; ++k) {
    scene.add({kWidth * uniform(random), kHeight * uniform(random), 900.0 / (0.01 + uniform(random)), 0.8, 0.0, 1.2});
  }
  return scene.expose({}, random);
}

void detect(benchmark::State& state) {
  const auto pixels = star_field(static_cast<int>(state.range(0)));
  const auto detector = std::make_unique<ObjectDetector>();
  DetectionReport report;
  for (auto _ : state) {
    report = detector->detect(vbar::test::view_of(pixels, kWidth, kHeight), {});
    benchmark::DoNotOptimize(report);
  }
  state.counters["objects"] = report.objects;
}

std::vector<vbar::image_tile> tiles() {
  const auto pixels = star_field(50);
  std::vector<vbar::image_tile> all;
  for (std::size_t first = 0; first < pixels.size(); first += kTilePixels12) {
    vbar::image_tile tile{};
    const std::size_t count = std::min<std::size_t>(kTilePixels12, pixels.size() - first);
    tile.tile = static_cast<std::int16_t>(all.size());
    tile.tiles = 461;
    tile.width = kWidth;
    tile.height = kHeight;
    tile.bits = 12;
    tile.pixels = static_cast<std::int16_t>(count);
    pack_pixels(std::span(pixels).subspan(first, count), 12, tile.data);
    all.push_back(tile);
  }
  return all;
}

void unpack(benchmark::State& state) {
  const auto all = tiles();
  const auto assembly = std::make_unique<ImageAssembly>();
  std::int64_t time = 0;
  for (auto _ : state) {
    ++time;
    for (const vbar::image_tile& tile : all) benchmark::DoNotOptimize(assembly->take({time}, 0, tile));
  }
  if (assembly->tiles_missing() != 0) state.SkipWithError("the image is not complete");
}

BENCHMARK(detect)->Name("imaging/detect/400000")->Arg(50)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(unpack)->Name("imaging/unpack/400000")->Unit(benchmark::kMillisecond);

}  // namespace
