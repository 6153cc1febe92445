// Size and cost of an image in a log: JPEG-LS, as it is recorded, side by side with PNG. 500 x 800 pixels of 12 bits
// with the noise of the digital detector and 150 stars.

#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>
#include <png.h>

#include "host_sim/report/image_png.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/recorded_image.h"

namespace {

namespace camera = vbar::twins::camera;

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
