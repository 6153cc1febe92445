// Images a second from the emulated camera through the client over 127.0.0.0/8, device and client in one process:
// trigger, packets, unpacking. The picture itself is made beforehand.

#include <benchmark/benchmark.h>

#include "hil_drivers/gige/camera/camera.h"
#include "tests/unit/emulators/gige/running_device.h"

namespace {

using namespace vbar::gige;

void take_images(benchmark::State& state, const vbar::twins::camera::Region& region, wire::PixelFormat format) {
  const Image picture = test::numbered_picture({region, 0.0, 0.0, 0.0, 0});
  test::RunningDevice device({}, [&picture](const Request& /*request*/) { return picture; });
  Camera::Settings settings;
  settings.address = device.address();
  settings.exposure_s = 1e-3;
  settings.region = region;
  settings.pixel_format = format;
  Camera camera(settings);
  camera.open();
  std::int64_t images = 0, failures = 0, resent = 0;
  for (auto _ : state) {
    const auto result = camera.take();
    if (const auto* frame = std::get_if<Frame>(&result)) {
      ++images;
      resent += frame->packets_resent;
    } else {
      ++failures;
    }
  }
  state.counters["images"] = benchmark::Counter(static_cast<double>(images), benchmark::Counter::kIsRate);
  state.counters["failures"] = static_cast<double>(failures);
  state.counters["packets_resent"] = static_cast<double>(resent);
}

void BM_GigeRegion(benchmark::State& state) {
  take_images(state, {710, 152, 500, 848}, wire::PixelFormat::kMono16);
}
BENCHMARK(BM_GigeRegion)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_GigeRegionPacked(benchmark::State& state) {
  take_images(state, {710, 152, 500, 848}, wire::PixelFormat::kMono12Packed);
}
BENCHMARK(BM_GigeRegionPacked)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_GigeWholeSensor(benchmark::State& state) {
  take_images(state, {0, 0, 1920, 1200}, wire::PixelFormat::kMono16);
}
BENCHMARK(BM_GigeWholeSensor)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
