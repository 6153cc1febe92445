// The cost of baseband samples: 100 ms of 11 satellites at 2.6 Msps, and of noise alone. Target: 13 ms.

#include <benchmark/benchmark.h>

#include "hil_drivers/grand/bench/samples/baseband.h"
#include "tests/support/gnss_scene.h"

namespace {

using namespace vbar;
using grand::bench::Baseband;
using grand::bench::RfBlock;
using grand::bench::RfSignal;

void samples(benchmark::State& state) {
  Baseband baseband({}, test::constellation(1), 1, "servicer");
  RfBlock block{.begin = test::kGnssStart, .snapped = false, .signals = {}};
  for (int k = 0; k < state.range(0); ++k) {
    RfSignal& signal = block.signals.emplace_back();
    signal.satellite = {twins::gnss::System::kGps, k + 2};
    signal.carrier_m.coefficients = signal.code_m.coefficients = {2.1e7 + 1e5 * k, 900.0 * k - 5000.0, 4.0, 0, 0, 0};
    signal.cn0_dbhz = 45.0;
  }
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(baseband.samples(block));
    block.begin = block.begin + RfBlock::kLength;
  }
}

BENCHMARK(samples)->Name("grand_samples/block_of_100_ms")->Arg(0)->Arg(11)->Unit(benchmark::kMillisecond);

}  // namespace
