#include "emulators/grand/receiver/tracking_loops.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "emulators/grand/receiver/signal_channel.h"

namespace vbar::grand::bench::test {
namespace {

using twins::gnss::SatelliteId;
using twins::gnss::Signal;
using twins::gnss::System;

constexpr double kLambda_m = fsw::gnss::kSpeedOfLight / fsw::gnss::kL1_Hz;

double amplitude_of(double cn0_dbhz) {
  return std::sqrt(2.0 * std::pow(10.0, cn0_dbhz / 10.0) * kUpdate_s);
}

/// Range of a satellite to a low orbit: a sine of the orbit's period with an acceleration of 8 m/s^2, as a quintic for
/// each 100 ms. (A cubic of it would do: the next term is below 1e-9 m.)
RfSignal orbit_arc(double t_s, bool moving) {
  RfSignal rf;
  constexpr double kRate = 2.0 * std::numbers::pi / 5940.0;
  constexpr double kAmplitude_m = 8.0 / (kRate * kRate);
  const double s = std::sin(kRate * t_s);
  const double c = std::cos(kRate * t_s);
  if (moving) {
    rf.carrier_m.coefficients = {kAmplitude_m * s,
                                 kAmplitude_m * kRate * c,
                                 -kAmplitude_m * kRate * kRate * s / 2.0,
                                 -kAmplitude_m * kRate * kRate * kRate * c / 6.0,
                                 0.0,
                                 0.0};
  }
  rf.carrier_m.coefficients[0] += 2.2e7;
  rf.code_m = rf.carrier_m;
  return rf;
}

/// Errors of phase (m, half cycles removed) and code (m) at every update, after the loops have settled.
struct Errors {
  std::vector<double> phase_m, code_m;
};
Errors track(const LoopSettings& settings, double cn0_dbhz, double duration_s, bool moving, double settle_s = 20.0,
             std::uint64_t seed = 1) {
  TrackingLoops loops(settings, Signal::kGpsL1);
  NormalNoise noise(seed, "test/loops");
  const BlockSeries quiet{};
  BlockSeries motion{};
  std::array<LoopSnapshot, kUpdatesPerBlock> snapshots;
  const RfSignal first = orbit_arc(0.0, moving);
  loops.start(first.carrier_m.at(0.0) / kLambda_m, first.carrier_m.rate_at(0.0) / kLambda_m, first.code_m.at(0.0));
  loops.set_mode(LoopMode::kPhase);
  loops.set_amplitude_estimate(amplitude_of(cn0_dbhz));
  Errors errors;
  const auto blocks = static_cast<int>(duration_s * 10.0);
  for (int block = 0; block < blocks; ++block) {
    const RfSignal rf = orbit_arc(0.1 * block, moving);
    LoopInput input{&rf, &quiet, amplitude_of(cn0_dbhz), nullptr, (1U << kUpdatesPerBlock) - 1U};
    loops.advance(input, noise, snapshots.data(), motion);
    if (0.1 * block < settle_s) continue;
    for (std::size_t k = 0; k < kUpdatesPerBlock; ++k) {
      const double s = 0.01 * static_cast<double>(k);
      const double half_cycles = 2.0 * (snapshots[k].phase_cycles - rf.carrier_m.at(s) / kLambda_m);
      errors.phase_m.push_back((half_cycles - std::nearbyint(half_cycles)) / 2.0 * kLambda_m);
      errors.code_m.push_back(snapshots[k].code_m - rf.code_m.at(s));
    }
  }
  return errors;
}

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

double deviation(const std::vector<double>& x) {
  const double m = mean(x);
  double sum = 0.0;
  for (const double value : x) sum += (value - m) * (value - m);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double correlation(const std::vector<double>& x, std::size_t lag) {
  const double m = mean(x);
  double sum = 0.0;
  double square = 0.0;
  for (std::size_t k = 0; k + lag < x.size(); ++k) sum += (x[k] - m) * (x[k + lag] - m);
  for (const double value : x) square += (value - m) * (value - m);
  return sum / square;
}

// Kaplan, Hegarty, "Understanding GPS/GNSS" (2017), 8.3.3.1: thermal noise of an arctangent PLL, m.
double kaplan_phase_sigma_m(double bandwidth_hz, double cn0_dbhz) {
  const double cn0 = std::pow(10.0, cn0_dbhz / 10.0);
  return kLambda_m / (2.0 * std::numbers::pi) * std::sqrt(bandwidth_hz / cn0 * (1.0 + 1.0 / (2.0 * kUpdate_s * cn0)));
}

// The same, 8.4.3, coherent early minus late (no squaring loss), spacing 0.1 chip, m.
double kaplan_code_sigma_m(double bandwidth_hz, double cn0_dbhz) {
  const double chip_m = fsw::gnss::kSpeedOfLight / 1.023e6;
  return chip_m * std::sqrt(bandwidth_hz * 0.1 / (2.0 * std::pow(10.0, cn0_dbhz / 10.0)));
}

// 15 %: the formula is that of a continuous loop, the discrete one with B T = 0.15 has 8 % more noise; a deviation from
// 2000 s with a correlation of some 20 ms is known to 1 %.
TEST(TrackingLoops, PhaseNoiseIsThatOfKaplanAndHegarty) {
  for (const double cn0_dbhz : {38.0, 42.0, 46.0}) {
    const Errors errors = track({}, cn0_dbhz, 2000.0, true);
    const double sigma_m = deviation(errors.phase_m);
    EXPECT_NEAR(sigma_m / kaplan_phase_sigma_m(15.0, cn0_dbhz), 1.0, 0.15) << cn0_dbhz << " dB-Hz: " << sigma_m;
    // White over 10 s, which a filter at that period takes it for. The estimate's own noise is 0.01.
    EXPECT_NEAR(correlation(errors.phase_m, 1000), 0.0, 0.07);
    RecordProperty(std::to_string(cn0_dbhz), std::to_string(sigma_m / kaplan_phase_sigma_m(15.0, cn0_dbhz)));
  }
}

// Estimates of a loop of time constant 1/(4 B): 8000 s hold 4000 independent ones at 0.25 Hz (1 %), 160 at 0.01 Hz (8
// %).
TEST(TrackingLoops, CodeNoiseIsThatOfACoherentDelayLockLoop) {
  LoopSettings settings;
  Errors errors = track(settings, 45.0, 4000.0, true);
  EXPECT_NEAR(deviation(errors.code_m) / kaplan_code_sigma_m(0.25, 45.0), 1.0, 0.1);
  EXPECT_NEAR(correlation(errors.code_m, 1000), 0.0, 0.15);
  settings.code_bandwidth_hz = 0.01;
  errors = track(settings, 45.0, 8000.0, true, 200.0);
  EXPECT_NEAR(deviation(errors.code_m) / kaplan_code_sigma_m(0.01, 45.0), 1.0, 0.2);
  // exp(-4 B 10 s) = 0.67.
  EXPECT_NEAR(correlation(errors.code_m, 1000), 0.67, 0.15);
}

// Under a constant acceleration a the rate has to grow by a T in each update, which takes dx = a/w^2: that is the error
// of the predicted phase. The estimate after the update is nearer by the gain: (1 - 1.414 w T) a/w^2, 0.6 a/w^2 here.
TEST(TrackingLoops, SecondOrderLoopLagsByTheAcceleration) {
  LoopSettings settings;
  settings.carrier_order = 2;
  const Errors errors = track(settings, 60.0, 5940.0, true);  // a whole period: 60 dB-Hz leaves the lag alone
  const double w = 15.0 / 0.53;
  const double lag_m = 8.0 / (w * w) * (1.0 - std::numbers::sqrt2 * w * kUpdate_s);
  // The lag follows the sine of the acceleration: its deviation is that of a sine of this amplitude.
  EXPECT_NEAR(deviation(errors.phase_m) * std::numbers::sqrt2 / lag_m, 1.0, 0.15);
  EXPECT_GT(correlation(errors.phase_m, 1000), 0.9);
  // A third-order loop has none of it.
  EXPECT_LT(deviation(track({}, 60.0, 5940.0, true).phase_m), 0.1 * lag_m);
}

/// A channel on the moving signal from the search on: seconds until it locks, -1 for never.
double seconds_to_lock(const LoopSettings& settings, double cn0_dbhz, std::uint64_t seed, double phase_of_orbit_s) {
  SignalChannel channel(settings, SatelliteId{System::kGps, 7}, Signal::kGpsL1, seed, "test");
  const BlockSeries quiet{};
  for (int block = 0; block < 600; ++block) {
    const RfSignal rf = orbit_arc(phase_of_orbit_s + 0.1 * block, true);
    if (!channel.active()) channel.start_from_search(rf, 0.0, 0.0);
    channel.advance({&rf, &quiet, amplitude_of(cn0_dbhz), nullptr, 0}, 100.0);
    if (channel.phase_lock()) return 0.1 * (block + 1);
  }
  return -1.0;
}

// A quarter of the orbit after its start the acceleration is 8 m/s^2, 42 Hz/s: more than the unaided loop of 5 Hz can
// be handed over with.
TEST(TrackingLoops, FiveHertzUnaidedNeverLocksInOrbit) {
  LoopSettings narrow;
  narrow.carrier_bandwidth_hz = 5.0;
  constexpr double kQuarter_s = 1485.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EXPECT_EQ(seconds_to_lock(narrow, 45.0, seed, kQuarter_s), -1.0) << seed;
    const double standard_s = seconds_to_lock({}, 45.0, seed, kQuarter_s);
    EXPECT_GT(standard_s, 1.0) << seed;
    EXPECT_LT(standard_s, 10.0) << seed;
  }
}

// The estimate of C/N0 from narrow- and wide-band power, 1 s: its deviation is 0.15 dB at 45 dB-Hz.
TEST(SignalChannel, MeasuresCarrierToNoise) {
  for (const double cn0_dbhz : {32.0, 38.0, 45.0, 50.0}) {
    SignalChannel channel({}, SatelliteId{System::kGps, 7}, Signal::kGpsL1, 3, "test");
    const BlockSeries quiet{};
    double sum = 0.0;
    int count = 0;
    for (int block = 0; block < 600; ++block) {
      const RfSignal rf = orbit_arc(0.1 * block, true);
      if (block == 0) channel.start_from_search(rf, 0.0, 0.0);
      channel.advance({&rf, &quiet, amplitude_of(cn0_dbhz), nullptr, 0}, 100.0);
      if (block < 100 || block % 10 != 0) continue;
      sum += channel.cn0_dbhz();
      ++count;
    }
    EXPECT_TRUE(channel.phase_lock()) << cn0_dbhz;
    EXPECT_NEAR(sum / count, cn0_dbhz, 0.3);
  }
}

// The range of a smoothed code: 1.4 s of correlation in 100 s leave a tenth of the code's noise; the phase it follows
// is exact. Without smoothing it is the code itself.
TEST(SignalChannel, SmoothsTheCodeByTheCarrier) {
  for (const double smoothing_s : {0.0, 100.0}) {
    std::vector<double> errors;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      SignalChannel channel({}, SatelliteId{System::kGps, 7}, Signal::kGpsL1, seed, "test");
      const BlockSeries quiet{};
      for (int block = 0; block < 3000; ++block) {
        const RfSignal rf = orbit_arc(0.1 * block, true);
        if (block == 0) channel.start_from_search(rf, 0.0, 0.0);
        channel.advance({&rf, &quiet, amplitude_of(45.0), nullptr, 1U}, smoothing_s);
        if (block >= 2000 && block % 500 == 0)
          errors.push_back(channel.measurement(0).smoothed_code_m - rf.code_m.at(0.0));
      }
    }
    // A mean over 100 s of a process of time constant 1 s has sqrt(2/100) of its deviation; an exponential one
    // sqrt(1/100). 80 values: 8 %; two bounds of three sigma.
    const double expected_m = kaplan_code_sigma_m(0.25, 45.0) * (smoothing_s > 0.0 ? 0.1 : 1.0);
    EXPECT_NEAR(deviation(errors) / expected_m, 1.0, 0.3) << smoothing_s;
  }
}

// The phase is known to whole cycles once the message has given the sign of the bits, to half cycles before.
TEST(SignalChannel, HalfCycleIsResolved) {
  int off_by_half = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SignalChannel channel({}, SatelliteId{System::kGps, 7}, Signal::kGpsL1, seed, "test");
    const BlockSeries quiet{};
    for (int block = 0; block < 100; ++block) {
      const RfSignal rf = orbit_arc(0.1 * block, true);
      if (block == 0) channel.start_from_search(rf, 0.0, 0.0);
      channel.advance({&rf, &quiet, amplitude_of(45.0), nullptr, 1U}, 100.0);
      const auto error = [&] {
        const double cycles = channel.measurement(0).loop.phase_cycles - rf.carrier_m.at(0.0) / kLambda_m;
        return cycles - std::nearbyint(cycles);
      };
      if (block != 99) continue;
      EXPECT_FALSE(channel.measurement(0).parity_known);
      if (!(std::abs(error()) <= 0.25)) ++off_by_half;
      EXPECT_TRUE(channel.resolve_half_cycle());
      EXPECT_TRUE(channel.measurement(0).parity_known);
      EXPECT_NEAR(error(), 0.0, 0.03) << seed;
    }
  }
  EXPECT_GT(off_by_half, 3);
  EXPECT_LT(off_by_half, 17);
}

// Without a signal the channel notices within seconds and stops.
TEST(SignalChannel, StopsWithoutASignal) {
  SignalChannel channel({}, SatelliteId{System::kGps, 7}, Signal::kGpsL1, 1, "test");
  const BlockSeries quiet{};
  for (int block = 0; block < 200; ++block) {
    const RfSignal rf = orbit_arc(0.1 * block, true);
    if (block == 0) channel.start_from_search(rf, 0.0, 0.0);
    const bool radiated = block < 100;
    channel.advance({radiated ? &rf : nullptr, &quiet, radiated ? amplitude_of(45.0) : 0.0, nullptr, 0}, 100.0);
    if (block == 99) {
      EXPECT_TRUE(channel.phase_lock());
    }
    if (block == 130) {
      EXPECT_FALSE(channel.phase_lock());
    }
    if (!channel.active()) break;
  }
  EXPECT_FALSE(channel.active());
}

TEST(NormalNoise, HasTheMomentsOfANormalDistribution) {
  NormalNoise noise(1, "test/noise");
  double sum = 0.0, square = 0.0, fourth = 0.0;
  constexpr int kDraws = 1'000'000;
  for (int k = 0; k < kDraws; ++k) {
    const double x = noise();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  // Four sigma of each: 1/sqrt(n), sqrt(2/n), sqrt(96/n).
  EXPECT_NEAR(sum / kDraws, 0.0, 0.004);
  EXPECT_NEAR(square / kDraws, 1.0, 0.006);
  EXPECT_NEAR(fourth / kDraws, 3.0, 0.04);
}

TEST(NormalNoise, FollowsTheQuantile) {
  const NormalTable& table = NormalTable::instance();
  for (int k = 1; k < 2000; ++k) {
    const double p = k / 2000.0;
    const auto bits = static_cast<std::uint64_t>(std::ldexp(p, 64));
    EXPECT_NEAR(table.quantile(bits), engine::normal_quantile(p), 3e-5) << p;
  }
}

}  // namespace
}  // namespace vbar::grand::bench::test
