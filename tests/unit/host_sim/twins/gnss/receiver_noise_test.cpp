// The measured noise of an emulated receiver against the formulas of its loops.

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/point_solution.h"
#include "host_sim/twins/gnss/tracking.h"
#include "tests/support/accuracy.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/paths.h"

namespace vbar::twins::gnss {

namespace {

struct Sums {
  double code = 0.0, carrier = 0.0, product = 0.0;
  int count = 0;
};

// Observed minus true, each divided by the standard deviation that the formulas give at its C/N0: unit variance, and no
// correlation of code and carrier. Some 20,000 observations a signal: 4 sigma of the variance are 4 %.
TEST(GnssReceiverNoise, HasTheLoopsVariances) {
  GnssReceiver receiver({}, test::constellation(11), test::data_directory(), 11, "servicer");
  std::map<Signal, Sums> sums;
  const TrackingSettings& tracking = receiver.settings().tracking;
  for (int k = 0; k < 1500; ++k) {
    receiver.bytes_at(test::in_orbit(10.0 * k));
    for (std::size_t n = 0; n < receiver.observations().size(); ++n) {
      const oem::RangeRecord& record = receiver.observations()[n];
      const ObservationTruth& truth = receiver.truth().observations[n];
      const double lambda = wavelength_m(record.signal);
      const double code =
          (record.pseudorange_m - truth.code_m) / code_noise_m(tracking, record.signal, record.cn0_dbhz);
      const double phase_m =
          (record.carrier_phase_cycles - static_cast<double>(truth.ambiguity_cycles) - truth.carrier_fraction_cycles) *
              lambda -
          truth.carrier_m;
      const double carrier = phase_m / carrier_noise_m(tracking, record.signal, record.cn0_dbhz);
      Sums& s = sums[record.signal];
      s.code += code * code;
      s.carrier += carrier * carrier;
      s.product += code * carrier;
      ++s.count;
    }
  }
  accuracy::Largest worst;
  for (const auto& [signal, s] : sums) {
    const double tolerance = 4.0 * std::sqrt(2.0 / s.count);
    EXPECT_NEAR(s.code / s.count, 1.0, tolerance) << structure(signal).name;
    EXPECT_NEAR(s.carrier / s.count, 1.0, tolerance) << structure(signal).name;
    EXPECT_NEAR(s.product / s.count, 0.0, tolerance) << structure(signal).name;
    if (signal == Signal::kGpsL1) worst.add(std::abs(s.code / s.count - 1.0), std::abs(s.carrier / s.count - 1.0));
  }
  EXPECT_GT(sums[Signal::kGpsL1].count, 15000);
  accuracy::expect_below("GNSS emulator: noise of code and carrier, variance", "loop formulas of Kaplan and Hegarty",
                         worst, 0.04, "relative");
}

/// The carrier of each observation of an epoch.
std::map<std::pair<SatelliteId, Signal>, double> carriers_cycles(const GnssReceiver& receiver) {
  std::map<std::pair<SatelliteId, Signal>, double> carriers;
  for (const oem::RangeRecord& record : receiver.observations())
    carriers[{record.satellite, record.signal}] = record.carrier_phase_cycles;
  return carriers;
}

// The wander of a receiver is the only difference to the same receiver without it. 1.5 mm over 60 s at every 60 s: each
// value has a correlation of exp(-1) with the next one, so that n values weigh as n (1 - exp(-2)) / (1 + exp(-2)) =
// 0.76 n independent squares.
TEST(GnssReceiverNoise, WanderIsThatOfASeparateStreamOfEachCarrier) {
  GnssReceiverSettings wandering;
  wandering.tracking.carrier_wander_sigma_mm = 1.5;
  wandering.tracking.carrier_wander_time_s = 60.0;
  GnssReceiver plain({}, test::constellation(11), test::data_directory(), 11, "servicer");
  GnssReceiver receiver(wandering, test::constellation(11), test::data_directory(), 11, "servicer");
  std::map<std::pair<SatelliteId, Signal>, double> before_mm;
  double squares = 0.0, products = 0.0, across_signals = 0.0;
  int count = 0, pairs = 0, signal_pairs = 0;
  for (int k = 0; k < 300; ++k) {
    receiver.bytes_at(test::in_orbit(60.0 * k));
    plain.bytes_at(test::in_orbit(60.0 * k));
    const auto without = carriers_cycles(plain);
    std::map<std::pair<SatelliteId, Signal>, double> now_mm;
    for (const auto& [channel, cycles] : carriers_cycles(receiver)) {
      const double wander_mm = 1e3 * wavelength_m(channel.second) * (cycles - without.at(channel));
      now_mm[channel] = wander_mm;
      squares += wander_mm * wander_mm;
      ++count;
      if (const auto last = before_mm.find(channel); last != before_mm.end()) {
        products += wander_mm * last->second;
        ++pairs;
      }
      const auto first_signal = now_mm.find({channel.first, Signal::kGpsL1});
      if (channel.second == Signal::kGpsL2 && first_signal != now_mm.end()) {
        across_signals += wander_mm * first_signal->second;
        ++signal_pairs;
      }
    }
    before_mm = now_mm;
  }
  ASSERT_GT(count, 3000);
  ASSERT_GT(signal_pairs, 1000);
  const double variance = 1.5 * 1.5;
  EXPECT_NEAR(squares / count / variance, 1.0, 4.0 * std::sqrt(2.0 / (0.76 * count)));
  EXPECT_NEAR(products / pairs / variance, std::exp(-1.0), 4.0 * std::sqrt(1.4 / (0.76 * pairs)));
  EXPECT_NEAR(across_signals / signal_pairs / variance, 0.0, 4.0 * std::sqrt(1.0 / (0.76 * signal_pairs)));
}

}  // namespace

namespace {

ClockSettings quiet_start() {
  ClockSettings settings;
  settings.initial_offset_ms = 0.0;
  settings.initial_drift_sigma_ns_per_s = 0.0;
  return settings;
}

// After t the two-state model has variances S_f t + S_g t^3/3 and S_g t and covariance S_g t^2/2, whatever the steps
// between: 3000 clocks, 10 steps of 100 s; a sample variance of 3000 is within 10 % (4 sigma).
TEST(ReceiverClock, GrowsAsTheTwoStateModel) {
  const ClockSettings settings = quiet_start();
  constexpr int kClocks = 3000;
  double bias_square = 0.0;
  double drift_square = 0.0;
  double product = 0.0;
  for (std::uint64_t seed = 0; seed < kClocks; ++seed) {
    ReceiverClock clock(settings, seed, "test");
    for (int step = 0; step < 10; ++step) clock.advance(100.0);
    bias_square += clock.offset_s() * clock.offset_s();
    drift_square += clock.drift() * clock.drift();
    product += clock.offset_s() * clock.drift();
  }
  const double s_f = 1e-19;
  const double s_g = 2.0 * 9.8696044 * 2e-20;
  const double t = 1000.0;
  EXPECT_NEAR(bias_square / kClocks / (s_f * t + s_g * t * t * t / 3.0), 1.0, 0.1);
  EXPECT_NEAR(drift_square / kClocks / (s_g * t), 1.0, 0.1);
  EXPECT_NEAR(product / kClocks / (s_g * t * t / 2.0), 1.0, 0.12);
}

// A fast clock is set by whole milliseconds and stays within half of one.
TEST(ReceiverClock, IsSetByWholeMilliseconds) {
  ClockSettings settings;
  settings.initial_drift_sigma_ns_per_s = 5000.0;
  ReceiverClock clock(settings, 4, "test");
  int jumps = 0;
  for (int k = 0; k < 6000; ++k) {
    const double before = clock.offset_s();
    const double drift = clock.drift();
    clock.advance(1.0);
    EXPECT_LE(std::abs(clock.offset_s()), 0.5e-3);
    if (clock.jumps() == jumps) continue;
    jumps = clock.jumps();
    const double step_ms = (clock.offset_s() - before - drift) * 1e3;
    EXPECT_NEAR(std::abs(step_ms), 1.0, 1e-5);  // noise of one second: nanoseconds
  }
  EXPECT_GT(jumps, 2);
}

}  // namespace

namespace {

// Standard deviations computed by hand from the printed formulas, to their last digit: narrow correlator, 0.25 Hz, 20
// ms; Costas loop of 15 Hz.
TEST(SignalNoise, LoopsFollowTheirFormulas) {
  const TrackingSettings settings;
  const double code_m[] = {0.329, 0.184, 0.104};
  const double l1_mm[] = {1.174, 0.660, 0.371};
  const double l2_mm[] = {1.507, 0.847, 0.476};
  for (int k = 0; k < 3; ++k) {
    const double cn0 = 40.0 + 5.0 * k;
    EXPECT_NEAR(code_noise_m(settings, Signal::kGpsL1, cn0), code_m[k], 6e-4) << cn0;
    EXPECT_NEAR(carrier_noise_m(settings, Signal::kGpsL1, cn0) * 1e3, l1_mm[k], 6e-4) << cn0;
    EXPECT_NEAR(carrier_noise_m(settings, Signal::kGpsL2, cn0) * 1e3, l2_mm[k], 6e-4) << cn0;
  }
}

// A link budget by hand: -158.5 dBW at 25,240 km, gain 4 dBi, losses 2 dB, noise temperature 130 + 290 (10^0.2 - 1) +
// 290 (10^0.8 - 1)/10^3.3 K = 300.4 K, so N0 = -203.82 dBW/Hz. Free space: 6.02 dB for half the distance.
TEST(SignalNoise, LinkBudget) {
  const LinkBudgetSettings settings;
  EXPECT_NEAR(carrier_to_noise_dbhz(settings, Signal::kGpsL1, 25.24e6, 0.0), 47.32, 0.01);
  EXPECT_NEAR(carrier_to_noise_dbhz(settings, Signal::kGpsL1, 12.62e6, 0.0), 47.32 + 6.02, 0.01);
  EXPECT_NEAR(carrier_to_noise_dbhz(settings, Signal::kGpsL1, 25.24e6, 8.89), 47.32 - 8.89, 0.01);
}

// Values of the pattern's file at and between its angles.
TEST(SignalNoise, AntennaPattern) {
  const AntennaPattern pattern = AntennaPattern::load(std::filesystem::path(vbar::tests::source_path("data")));
  const auto at_deg = [&pattern](double angle) {
    return pattern.attenuation_db(std::cos(angle * std::numbers::pi / 180));
  };
  EXPECT_NEAR(at_deg(0.0), 0.0, 1e-9);
  EXPECT_NEAR(at_deg(60.0), 4.89, 1e-9);
  EXPECT_NEAR(at_deg(92.5), (8.89 + 9.78) / 2.0, 1e-9);
  EXPECT_NEAR(at_deg(180.0), 31.56, 1e-9);
  EXPECT_THROW(AntennaPattern::load("/nonexistent"), std::runtime_error);
}

}  // namespace

}  // namespace vbar::twins::gnss
