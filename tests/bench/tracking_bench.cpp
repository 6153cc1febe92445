// Target tracking: an image of many false detections, all places for hypotheses taken.

#include <vector>

#include <benchmark/benchmark.h>

#include "tests/unit/fsw/tracking/scene.h"

namespace {

using namespace vbar;

void update(benchmark::State& state) {
  testing::SceneSettings settings;
  settings.false_detections = 100.0;
  testing::SceneMaker maker(settings);
  fsw::tracking::TargetTracker warm;
  for (int k = 0; k < 40; ++k) {
    const testing::Scene scene = maker.next();
    if (!warm.step(scene.input()).ok()) state.SkipWithError("the tracker refused an image");
  }
  const testing::Scene scene = maker.next();
  int hypotheses = 0;
  for (auto _ : state) {
    state.PauseTiming();
    fsw::tracking::TargetTracker tracker = warm;
    state.ResumeTiming();
    const auto output = tracker.step(scene.input());
    hypotheses = output.value().hypotheses;
    benchmark::DoNotOptimize(hypotheses);
  }
  state.counters["hypotheses"] = hypotheses;
}

BENCHMARK(update)->Name("tracking/update/64")->Unit(benchmark::kMicrosecond);

}  // namespace
