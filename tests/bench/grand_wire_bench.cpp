// What one trajectory sample costs: its computation, its datagram, and the lock-step round trip between the driver and
// the control server over 127.0.0.1 (with an engine that flies it at once). A flight of 2.25 h of two spacecraft takes
// 162,000 of them.

#include <benchmark/benchmark.h>

#include "fsw/gnss/constants.h"
#include "hil_drivers/grand/trajectory/antenna_trajectory.h"
#include "hil_drivers/grand/wire/skydel_hil.h"
#include "tests/support/gnss_scene.h"
#include "tests/unit/hil_drivers/grand/generators/loopback.h"

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
  for (auto _ : state) benchmark::DoNotOptimize(wire::decode_hil(wire::encode_sample(sample)));
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
