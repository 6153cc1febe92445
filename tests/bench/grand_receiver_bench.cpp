// The emulated receiver: an update of one channel's loops (10 ms of signal), and a second of a whole receiver.

#include <benchmark/benchmark.h>

#include "hil_drivers/grand/bench/receiver/receiver.h"
#include "hil_drivers/grand/bench/receiver/signal_channel.h"
#include "tests/support/synthetic_sky.h"

namespace {

using namespace vbar;
using namespace vbar::grand::bench;

void grand_loop_update(benchmark::State& state) {
  SignalChannel channel({}, twins::gnss::SatelliteId{twins::gnss::System::kGps, 7}, twins::gnss::Signal::kGpsL1, 1,
                        "bench");
  RfSignal rf;
  rf.carrier_m.coefficients = {2.2e7, 3000.0, 4.0, -1e-3, 1e-6, 0.0};
  rf.code_m = rf.carrier_m;
  const BlockSeries quiet{};
  channel.start_from_search(rf, 0.0, 0.0);
  double begin_m = 2.2e7;
  for ([[maybe_unused]] auto _ : state) {
    channel.advance({&rf, &quiet, 25.0, nullptr, 0}, 100.0);
    begin_m = rf.carrier_m.at(0.1);
    rf.carrier_m.coefficients[0] = rf.code_m.coefficients[0] = begin_m;
    benchmark::DoNotOptimize(channel.rate_hz());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kUpdatesPerBlock));
}
BENCHMARK(grand_loop_update);

// With 31 to 33 signals; the radio field is made beforehand.
void grand_receiver_second(benchmark::State& state) {
  const auto constellation = test::constellation(1);
  test::SyntheticSky sky(constellation);
  std::vector<RfBlock> blocks;
  constexpr std::size_t kBlocks = 3000;
  for (std::size_t k = 0; k < kBlocks; ++k) blocks.push_back(sky.block(static_cast<std::int64_t>(k)));
  Receiver receiver({}, constellation, 1, "bench");
  receiver.power(true);
  receiver.idle(fsw::duration_of_seconds(3));
  for (const std::string line : {"LOG RANGEB ONTIME 10 9\r", "LOG BESTXYZB ONTIME 10 9\r", "LOG TIMEB ONTIME 10 9\r"})
    receiver.listen(0, {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, 115200);
  std::size_t next = 0;
  for (; next < 1000; ++next) receiver.advance(blocks[next]);
  for ([[maybe_unused]] auto _ : state) {
    for (int k = 0; k < 10; ++k) {
      receiver.advance(blocks[next]);
      next = next + 1 == kBlocks ? 1000 : next + 1;  // going back is a gap: the channels start again
    }
    benchmark::DoNotOptimize(receiver.speak(0).size());
  }
  state.counters["signals"] = receiver.report().signals_tracked;
}
BENCHMARK(grand_receiver_second)->Iterations(190);

}  // namespace
