// The counts of one picture: points of a sky, and light all over the region.

#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "emulators/optical_stimulator/optical_path.h"
#include "hil_drivers/optical_stimulator/pictures/picture_maker.h"
#include "host_sim/mission/data_file.h"

namespace {

namespace os = vbar::optical_stimulator;
using vbar::twins::camera::PhotonImage;
using vbar::twins::camera::Region;

constexpr int kWidth = 1920, kHeight = 1200;
constexpr Region kRegion{700, 190, 520, 820};

void draw(benchmark::State& state, float background) {
  const os::DisplayLight light({2.2, 3.0, 1e5}, kWidth, kHeight, std::vector<float>(kWidth * kHeight, 2.4e6F));
  PhotonImage wanted{kRegion, std::vector<float>(static_cast<std::size_t>(kRegion.width) * kRegion.height, background)};
  for (int star = 0; star < 60; ++star) {  // Gaussians of sigma 0.5 px, magnitudes 2 to 8 below a full pixel
    const double x = kRegion.x + 10.3 + (star * 7919) % 500, y = kRegion.y + 10.7 + (star * 104729) % 800;
    const double electrons = 2.4e6 * std::pow(10.0, -0.4 * (2.0 + 0.1 * star));
    for (int dy = -2; dy <= 3; ++dy)
      for (int dx = -2; dx <= 3; ++dx) {
        const double across = std::floor(x) + dx - x, down = std::floor(y) + dy - y;
        wanted.at(static_cast<int>(x) + dx, static_cast<int>(y) + dy) +=
            static_cast<float>(electrons * 0.64 * std::exp(-2.0 * (across * across + down * down)));
      }
  }
  os::PictureMaker maker(light);
  os::Picture picture(kWidth, kHeight);
  for (auto _ : state) {
    benchmark::DoNotOptimize(maker.draw(wanted, picture));
    benchmark::DoNotOptimize(picture.counts.data());
  }
}

BENCHMARK_CAPTURE(draw, stars, 0.0F)->Name("optical_stimulator/counts/60_stars")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(draw, grey, 400.0F)->Name("optical_stimulator/counts/light_all_over")->Unit(benchmark::kMillisecond);

}  // namespace

// The emulated bench's cost for one image: light of the region with a strip, stars and a target; of a frame that is lit
// all over; and the detector with it.

namespace {

namespace emulated = vbar::optical_stimulator::bench;

constexpr vbar::twins::camera::Region kLightRegion{710, 152, 500, 848}, kWhole{0, 0, 1920, 1200};

std::vector<std::uint8_t> frame_of(bool is_lit_all_over) {
  std::vector<std::uint8_t> counts(1920 * 1200, is_lit_all_over ? 60 : 0);
  if (is_lit_all_over) return counts;
  const auto patch = [&](int u, int v, int side, std::uint8_t count) {
    for (int y = v; y < v + side; ++y)
      for (int x = u; x < u + side; ++x) counts[static_cast<std::size_t>(1920 * y + x)] = count;
  };
  for (int cell = 0; cell < 24; cell += 2) patch(712 + 20 * cell, 160, 20, 200);
  for (int star = 0; star < 150; ++star) patch(720 + star * 7919 % 470, 210 + star * 104729 % 780, 5, 90);
  patch(950, 590, 30, 255);
  return counts;
}

emulated::BenchSettings settings() {
  return emulated::read_bench(vbar::mission::data_directory() / "benches/optical_stimulator.toml", {});
}

void light(benchmark::State& state, bool is_lit_all_over, const vbar::twins::camera::Region& region) {
  const emulated::BenchSettings bench = settings();
  const auto camera = emulated::camera_of(bench, vbar::mission::data_directory());
  const emulated::ErrorField field(bench.field, 1, 1920, 1200);
  const emulated::BenchOptics optics(bench.lenses, bench.pose, bench.optics, field, camera, 1920, 1200);
  emulated::LightPath path({1920, 1200, bench.light, camera, 1}, optics);
  const std::vector<std::uint8_t> counts = frame_of(is_lit_all_over);
  const emulated::ShownFrame frame{counts, 1.0};
  vbar::twins::camera::PhotonImage image{region, {}};
  path.expose({&frame, 1}, 0.2, 1.0, image);
  for (auto _ : state) {
    path.expose({&frame, 1}, 0.2, 1.0, image);
    benchmark::DoNotOptimize(image.electrons.data());
  }
}
BENCHMARK_CAPTURE(light, stars, false, kLightRegion)
    ->Name("os_bench/light/500x848_stars")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(light, all, true, kLightRegion)
    ->Name("os_bench/light/500x848_lit_all_over")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(light, whole, true, kWhole)
    ->Name("os_bench/light/1920x1200_lit_all_over")
    ->Unit(benchmark::kMillisecond);

void expose(benchmark::State& state) {
  const emulated::BenchSettings bench = settings();
  emulated::OpticalPath path(bench, emulated::camera_of(bench, vbar::mission::data_directory()));
  const emulated::Pictures pictures{{std::make_shared<const std::vector<std::uint8_t>>(frame_of(false)), 1.0}};
  std::vector<std::uint16_t> dn;
  std::uint64_t number = 0;
  for (auto _ : state) {
    path.expose(pictures, {kLightRegion, {0.2, 0.0, 64.0}}, {40.0, 34.29}, {}, number++, dn);
    benchmark::DoNotOptimize(dn.data());
  }
}
BENCHMARK(expose)->Name("os_bench/expose/500x848_stars")->Unit(benchmark::kMillisecond);

}  // namespace
