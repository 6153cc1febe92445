// What a receiver's bytes cost to decode, in bytes a second, and an ephemeris to evaluate. A line at 921,600 baud
// brings 92,160 bytes a second.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "fsw/gnss/lambda.h"
#include "fsw/gnss/receiver_decoder.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/paths.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"
#include "tests/unit/fsw/measurements/cdgnss_pair.h"

namespace {

using namespace vbar::fsw::gnss;
using Bytes = std::vector<std::uint8_t>;

Bytes real_log() {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/oemv_200911218.gps"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// As many open candidates as are followed: headers that announce 8 kB, one after the other.
Bytes false_starts() {
  constexpr std::array<std::uint8_t, 10> kHeader{0xAA, 0x44, 0x12, 28, 43, 0, 0, 0, 0x40, 0x1F};
  Bytes bytes;
  for (int k = 0; k < 5000; ++k) bytes.insert(bytes.end(), kHeader.begin(), kHeader.end());
  return bytes;
}

void decode(benchmark::State& state, const Bytes& bytes) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (auto _ : state) {
    for (const std::uint8_t byte : bytes) benchmark::DoNotOptimize(decoder->push(byte));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}

void evaluate(benchmark::State& state) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (const std::uint8_t byte : real_log()) benchmark::DoNotOptimize(decoder->push(byte));
  vbar::fsw::GpsTime time = decoder->ephemeris().toe;
  for (auto _ : state) {
    time.ns += 1'000'000;
    benchmark::DoNotOptimize(satellite_state(decoder->ephemeris(), time));
  }
}

BENCHMARK_CAPTURE(decode, log, real_log())->Name("gnss_decode/vbar/real_log");
BENCHMARK_CAPTURE(decode, false_starts, false_starts())->Name("gnss_decode/vbar/false_starts");
BENCHMARK(evaluate)->Name("gnss_ephemeris/vbar/state");

}  // namespace

// The cost of an epoch of one emulated GNSS receiver: a third experiment of 8100 s with two receivers at 0.1 Hz has
// 1620, and at 1000 times real time 8.1 s for everything.

namespace {

using namespace vbar;

void receiver_epoch(benchmark::State& state) {
  twins::gnss::GnssReceiver receiver({}, vbar::test::constellation(1), vbar::test::data_directory(), 1, "servicer");
  double t = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(receiver.bytes_at(vbar::test::in_orbit(t)));
    t += 10.0;
  }
}

void true_satellite(benchmark::State& state) {
  const auto constellation = vbar::test::constellation(1);
  double offset = 0.0;
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(constellation->true_state(7, vbar::test::kGnssStart, offset));
    offset += 1.0;
  }
}

BENCHMARK(receiver_epoch)->Name("gnss_emulator/epoch/49");
BENCHMARK(true_satellite)->Name("gnss_emulator/true_state/1");

}  // namespace

// Integer least squares on the double differences of satellite geometry: 100 sessions of every kind from strong to
// weak, in turn; one iteration is one problem, from float ambiguities to the two best integer vectors. RTKLIB's, where
// Debian's librtklib-dev is installed, on the same problems.

#ifdef VBAR_HAVE_RTKLIB
#include "tests/peers/rtklib/rtklib_lambda.h"
#endif

namespace {

std::vector<problems::Problem> sessions(Eigen::Index n) {
  problems::Random random(static_cast<std::uint64_t>(n));
  std::vector<problems::Problem> drawn;
  for (int i = 0; i < 100; ++i) {
    drawn.push_back(problems::draw(problems::random_session_covariance(n, random), random));
  }
  return drawn;
}

template <class Solve>
void solve_in_turn(benchmark::State& state, const Solve& solve) {
  const std::vector<problems::Problem> drawn = sessions(state.range(0));
  std::size_t next = 0;
  for (auto _ : state) {
    const problems::Problem& problem = drawn[next];
    next = (next + 1) % drawn.size();
    benchmark::DoNotOptimize(solve(problem));
  }
}

void vbar_lambda(benchmark::State& state) {
  solve_in_turn(state, [](const problems::Problem& problem) {
    return resolve_ambiguities({problem.ambiguities.data(), problem.size()},
                               {problem.covariance.data(), problem.size() * problem.size()});
  });
}
BENCHMARK(vbar_lambda)->Name("lambda/vbar")->Arg(8)->Arg(12)->Arg(20)->Arg(24);

#ifdef VBAR_HAVE_RTKLIB
void rtklib_lambda(benchmark::State& state) {
  Eigen::MatrixXd fixed(state.range(0), 2);
  std::array<double, 2> norm2{};
  solve_in_turn(state, [&](const problems::Problem& problem) {
    return vbar::peers::rtklib_lambda(problem.ambiguities, problem.covariance, fixed, norm2);
  });
}
BENCHMARK(rtklib_lambda)->Name("lambda/rtklib")->Arg(8)->Arg(12)->Arg(20)->Arg(24);
#endif

}  // namespace

// Carrier phase as an aid of the filter: what a pair of epochs of two receivers costs once its integers are held.

namespace {

using namespace vbar::fsw;
using measurements::test::FilterPair;

constexpr int kSettling = 60;
constexpr int kEpochs = 60;
constexpr Duration kPeriod = duration_of_seconds(10);

void epoch(benchmark::State& state, double wander_sigma_m) {
  FilterPair pair(1);
  if (wander_sigma_m > 0.0)
    pair.filter_settings.processes.of<fsw::measurements::PhaseWander>() = {.sigma = wander_sigma_m, .time_s = 60.0};
  pair.begin_filter();
  pair.fly_filter(kSettling);
  if (!pair.carrier->is_fixed()) std::abort();
  const filter::RelativeNavigationFilter settled = *pair.estimator;
  const measurements::CdgnssAiding settled_carrier = *pair.carrier;
  const measurements::GnssAbsoluteAiding settled_own = *pair.own;
  const GpsTime start = pair.tag;
  std::vector<gnss::ObservationEpoch> ours, theirs;
  for (int k = 0; k < kEpochs; ++k) {
    const GpsTime tag{start.ns + k * kPeriod.ns};
    ours.push_back(pair.servicer.observe(tag, pair.satellites, gnss::test::kEarth));
    theirs.push_back(pair.target.observe(tag, pair.satellites, gnss::test::kEarth));
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
