// The cost of an epoch of one emulated GNSS receiver: a third experiment of 8100 s with two receivers at 0.1 Hz has
// 1620, and at 1000 times real time 8.1 s for everything.

#include <vector>

#include <benchmark/benchmark.h>

#include "tests/support/gnss_scene.h"

namespace {

using namespace vbar;

void receiver_epoch(benchmark::State& state) {
  twins::gnss::GnssReceiver receiver({}, test::constellation(1), test::data_directory(), 1, "servicer");
  double t = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(receiver.bytes_at(test::in_orbit(t)));
    t += 10.0;
  }
}

void true_satellite(benchmark::State& state) {
  const auto constellation = test::constellation(1);
  double offset = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(constellation->true_state(7, test::kGnssStart, offset));
    offset += 1.0;
  }
}

BENCHMARK(receiver_epoch)->Name("gnss_emulator/epoch/49");
BENCHMARK(true_satellite)->Name("gnss_emulator/true_state/1");

}  // namespace
