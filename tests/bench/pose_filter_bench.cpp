// The pose filter: what 5 s between images and an image's eleven keypoints cost.

#include <cstdlib>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/integration/pose_filter/close_flight.h"

namespace {

using namespace vbar;

/// Navigation that has followed the target for five minutes of light, and the images after.
struct Settled {
  test::CloseFlight flight = test::fly_closely(0.2);
  std::vector<fsw::navigation::AttitudeState> attitudes = test::tumble(flight, 1.0, 1);
  test::SimulatedNetwork network{flight, attitudes, {.has_dark = false}, 1};
  std::unique_ptr<fsw::navigation::PoseNavigation> navigation = std::make_unique<fsw::navigation::PoseNavigation>();
  std::vector<fsw::navigation::PoseEpoch> epochs;
  std::vector<fsw::pose::Keypoints> keypoints;

  Settled() {
    if (navigation->configure(test::pose_settings(flight)) != fsw::Status::kOk) std::abort();
    for (std::size_t k = 0; k < 60; ++k) navigation->update(network.measure(k), {});
    keypoints.resize(60);
    for (std::size_t k = 0; k < 60; ++k) {
      epochs.push_back(network.measure(60 + k));
      keypoints[k] = *epochs[k].keypoints;
      epochs[k].keypoints = &keypoints[k];
    }
  }
};

void image(benchmark::State& state) {
  const Settled settled;
  for (auto _ : state) {
    state.PauseTiming();
    const auto navigation = std::make_unique<fsw::navigation::PoseNavigation>(*settled.navigation);
    state.ResumeTiming();
    for (const auto& epoch : settled.epochs) navigation->update(epoch, {});
    benchmark::DoNotOptimize(navigation->rate_body());
  }
  state.counters["image"] = benchmark::Counter(static_cast<double>(settled.epochs.size() * state.iterations()),
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(image)->Name("pose_filter/vbar/image")->Unit(benchmark::kMillisecond);

}  // namespace
