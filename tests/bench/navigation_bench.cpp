// Carrier-phase navigation: what a pair of epochs of two receivers costs once its integers are held.

#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/unit/fsw/navigation/cooperating_pair.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::navigation;
using test::CooperatingPair;

constexpr int kSettling = 60;
constexpr int kEpochs = 60;
constexpr Duration kPeriod = duration_of_seconds(10);

/// What one receiver brings.
struct Epoch {
  AttitudeSample attitude;
  gnss::ObservationEpoch observations;
};

Epoch epoch_of(test::SyntheticReceiver& receiver, const CooperatingPair& pair, GpsTime tag) {
  Epoch epoch;
  epoch.attitude.time = tag;
  epoch.attitude.R_eci_body = receiver.R_eci_body_at(tag);
  epoch.observations = receiver.observe(tag, pair.satellites, test::kEarth);
  return epoch;
}

void epoch(benchmark::State& state, double wander_sigma_m) {
  CooperatingPair pair(1);
  pair.settings.relative.phase_wander_sigma_m = wander_sigma_m;
  pair.settings.relative.phase_wander_time_s = 60.0;
  pair.begin();
  pair.fly(kSettling);
  const auto settled = std::make_unique<GnssNavigation>(*pair.navigation);
  std::vector<Epoch> ours, theirs;
  for (int k = 0; k < kEpochs; ++k) {
    const GpsTime tag{pair.tag.ns + k * kPeriod.ns};
    ours.push_back(epoch_of(pair.servicer, pair, tag));
    theirs.push_back(epoch_of(pair.target, pair, tag));
  }
  for (auto _ : state) {
    state.PauseTiming();
    const auto navigation = std::make_unique<GnssNavigation>(*settled);
    state.ResumeTiming();
    for (std::size_t k = 0; k < ours.size(); ++k) {
      navigation->take(Receiver::kServicer, ours[k].attitude);
      navigation->take(Receiver::kTarget, theirs[k].attitude);
      navigation->take(Receiver::kServicer, ours[k].observations);
      navigation->take(Receiver::kTarget, theirs[k].observations);
      navigation->update(ours[k].attitude.time, {});
    }
    benchmark::DoNotOptimize(navigation->relative().position_eci());
  }
  const RelativeUpdate& last = pair.navigation->last_update();
  state.counters["phases"] = last.phases_used;
  state.counters["codes"] = last.codes_used;
  state.counters["epoch"] = benchmark::Counter(static_cast<double>(kEpochs * state.iterations()),
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(epoch, white, 0.0)->Name("navigation/vbar/epoch")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(epoch, wander, 0.5e-3)
    ->Name("navigation/vbar/epoch_with_phase_wander")
    ->Unit(benchmark::kMillisecond);

}  // namespace
