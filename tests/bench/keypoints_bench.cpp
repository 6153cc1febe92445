// Keypoints as an aid of the filter: what 5 s between images and an image's eleven keypoints cost.

#include <cstdlib>
#include <memory>

#include <benchmark/benchmark.h>

#include "tests/unit/fsw/sources/keypoints/keypoint_flight.h"

namespace {

using namespace vbar;
using fsw::sources::KeypointFlight;

constexpr int kSettling = 60;
constexpr int kImages = 60;

void image(benchmark::State& state) {
  const test::CloseFlight flight = test::fly_closely(0.2);
  KeypointFlight flown(flight, {.has_dark = false}, 1.0, 1, fsw::sources::flight_blocks(flight),
                       fsw::sources::flight_settings());
  for (int k = 0; k < kSettling; ++k) flown.step();
  if (!flown.filter->has_attitude()) std::abort();
  std::vector<test::MeasuredEpoch> epochs;
  std::vector<fsw::pose::Keypoints> keypoints;
  for (int k = 0; k < kImages; ++k) {
    epochs.push_back(flown.network.measure(flown.next++));
    keypoints.push_back(*epochs.back().keypoints);
  }
  for (auto _ : state) {
    state.PauseTiming();
    const auto filter = std::make_unique<fsw::filter::RelativeNavigationFilter>(*flown.filter);
    const auto aiding = std::make_unique<fsw::sources::KeypointAiding>(*flown.aiding);
    state.ResumeTiming();
    for (std::size_t k = 0; k < epochs.size(); ++k) {
      filter->advance_to(epochs[k].time, {});
      aiding->process({.time = epochs[k].time,
                       .camera = flown.camera,
                       .sun_eci = epochs[k].sun_eci,
                       .R_camera_eci = epochs[k].R_camera_eci,
                       .keypoints = &keypoints[k],
                       .pnp = epochs[k].pnp},
                      *filter);
    }
    benchmark::DoNotOptimize(filter->roe());
  }
  state.counters["image"] = benchmark::Counter(static_cast<double>(kImages * state.iterations()),
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(image)->Name("keypoints/vbar/image")->Unit(benchmark::kMillisecond);

}  // namespace
