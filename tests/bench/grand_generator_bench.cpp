// The cost of the radio field of one vehicle: blocks of 100 ms. Two vehicles over 2.25 h are 162,000 blocks.

#include <benchmark/benchmark.h>

#include "hil_drivers/grand/bench/generator/sky.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"

namespace {

using namespace vbar;

void sky_block(benchmark::State& state) {
  auto orbits = std::make_shared<grand::bench::SatelliteOrbits>(test::constellation(1), test::kGnssStart);
  grand::bench::Sky sky({}, orbits, twins::gnss::AntennaPattern::load(test::data_directory()), 1, "servicer");
  grand::bench::VehicleMotion motion(fsw::Duration{165'000'000});
  std::vector<grand::TrajectorySample> samples;
  for (int k = 0; k <= 60000; ++k) samples.push_back(test::sample_in_orbit(0.1 * k));
  grand::bench::RfBlock block;
  std::int64_t number = 0;
  motion.receive(samples[0]);
  std::size_t signals = 0;
  for ([[maybe_unused]] auto _ : state) {
    if (number + 1 == static_cast<std::int64_t>(samples.size())) state.SkipWithError("more blocks than samples");
    motion.receive(samples[static_cast<std::size_t>(number) + 1]);
    motion.advance(fsw::Duration{(number + 1) * grand::bench::RfBlock::kLength.ns});
    sky.fill(motion, number++, true, block);
    signals += block.signals.size();
  }
  state.counters["signals"] = static_cast<double>(signals) / static_cast<double>(number);
}

BENCHMARK(sky_block)->Name("grand_generator/block")->Iterations(50000);

}  // namespace
