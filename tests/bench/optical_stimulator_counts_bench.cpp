// The counts of one picture: points of a sky, and light all over the region.

#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>

#include "hil_drivers/optical_stimulator/counts/picture_maker.h"

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
