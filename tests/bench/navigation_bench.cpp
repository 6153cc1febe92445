// Carrier phase as an aid of the filter: what a pair of epochs of two receivers costs once its integers are held.

#include <cstdlib>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/unit/fsw/sources/carrier_pair/trunk_pair.h"

namespace {

using namespace vbar::fsw;
using sources::test::FilterPair;

constexpr int kSettling = 60;
constexpr int kEpochs = 60;
constexpr Duration kPeriod = duration_of_seconds(10);

void epoch(benchmark::State& state, double wander_sigma_m) {
  FilterPair pair(1);
  if (wander_sigma_m > 0.0)
    pair.filter_settings.processes.of<fsw::sources::PhaseWander>() = {.sigma = wander_sigma_m, .time_s = 60.0};
  pair.begin_filter();
  pair.fly_trunk(kSettling);
  if (!pair.carrier->is_fixed()) std::abort();
  const filter::RelativeNavigationFilter settled = *pair.estimator;
  const sources::CarrierAiding settled_carrier = *pair.carrier;
  const sources::OwnGnssAiding settled_own = *pair.own;
  const GpsTime start = pair.tag;
  std::vector<gnss::ObservationEpoch> ours, theirs;
  for (int k = 0; k < kEpochs; ++k) {
    const GpsTime tag{start.ns + k * kPeriod.ns};
    ours.push_back(pair.servicer.observe(tag, pair.satellites, sources::test::kEarth));
    theirs.push_back(pair.target.observe(tag, pair.satellites, sources::test::kEarth));
  }
  for (auto _ : state) {
    state.PauseTiming();
    *pair.estimator = settled;
    *pair.carrier = settled_carrier;
    *pair.own = settled_own;
    pair.tag = start;
    state.ResumeTiming();
    for (std::size_t k = 0; k < ours.size(); ++k) {
      pair.step(ours[k], &theirs[k]);
      pair.tag = pair.tag + kPeriod;
    }
    benchmark::DoNotOptimize(pair.estimator->roe());
  }
  state.counters["phases"] = pair.carrier->last_update().phases_used;
  state.counters["codes"] = pair.carrier->last_update().codes_used;
  state.counters["epoch"] = benchmark::Counter(static_cast<double>(kEpochs * state.iterations()),
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(epoch, white, 0.0)->Name("navigation/vbar/epoch")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(epoch, wander, 0.7e-3)
    ->Name("navigation/vbar/epoch_with_phase_wander")
    ->Unit(benchmark::kMillisecond);

}  // namespace
