// The cost of the radio field of one vehicle: blocks of 100 ms. Two vehicles over 2.25 h are 162,000 blocks.

#include <benchmark/benchmark.h>

#include "emulators/grand/radio_field/sky.h"
#include "emulators/grand/receiver/receiver.h"
#include "emulators/grand/receiver/signal_channel.h"
#include "emulators/grand/samples/baseband.h"
#include "fsw/gnss/constants.h"
#include "hil_drivers/grand/trajectory/antenna_trajectory.h"
#include "hil_drivers/grand/wire/skydel.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"
#include "tests/support/synthetic_sky.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

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

// The emulated receiver: an update of one channel's loops (10 ms of signal), and a second of a whole receiver.

namespace {

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

// The cost of baseband samples: 100 ms of 11 satellites at 2.6 Msps, and of noise alone. Target: 13 ms.

namespace {

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

// What one trajectory sample costs: its computation, its datagram, and the lock-step round trip between the driver and
// the control server over 127.0.0.1 (with an engine that flies it at once). A flight of 2.25 h of two spacecraft takes
// 162,000 of them.

namespace {

using namespace vbar::grand;

void BM_GrandTrajectorySample(benchmark::State& state) {
  AntennaTrajectory antenna({}, {}, vbar::test::kGnssStart, 1, "servicer");
  vbar::twins::gnss::BodyTruth truth = vbar::test::in_orbit(100.0);
  truth.acceleration_eci = -1e-6 * truth.position_eci;
  truth.angular_acceleration_body = vbar::fsw::Vector3::Zero();
  for (auto _ : state) {
    truth.time.ns += 100'000'000;
    benchmark::DoNotOptimize(antenna.at(truth));
  }
}
BENCHMARK(BM_GrandTrajectorySample);

void BM_GrandSkydelDatagram(benchmark::State& state) {
  const TrajectorySample sample = vbar::grand::test::sample_at(vbar::grand::test::kTenth);
  for (auto _ : state)
    benchmark::DoNotOptimize(vbar::grand::wire::decode_hil(vbar::grand::wire::encode_sample(sample)));
}
BENCHMARK(BM_GrandSkydelDatagram);

void round_trip(benchmark::State& state, const std::string& kind, bench::ControlProtocol protocol) {
  bench::ControlSettings settings;
  settings.protocol = protocol;
  vbar::grand::test::Loopback loopback(settings);
  const auto generator = loopback.generator(kind);
  vbar::grand::test::prepare(*generator);
  generator->start();
  std::int64_t tenths = 0;
  for (auto _ : state) {
    const vbar::fsw::Duration time = vbar::grand::test::tenths(++tenths);
    generator->send(0, vbar::grand::test::sample_at(time));
    if (generator->wait_for(0, time, vbar::grand::test::soon()) < time) state.SkipWithError("no progress");
  }
}

void BM_GrandSkydelRoundTrip(benchmark::State& state) {
  round_trip(state, "skydel", bench::ControlProtocol::kSkydel);
}
BENCHMARK(BM_GrandSkydelRoundTrip)->MeasureProcessCPUTime()->UseRealTime();

void BM_GrandSimgenRoundTrip(benchmark::State& state) {
  round_trip(state, "simgen", bench::ControlProtocol::kSimgen);
}
BENCHMARK(BM_GrandSimgenRoundTrip)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
