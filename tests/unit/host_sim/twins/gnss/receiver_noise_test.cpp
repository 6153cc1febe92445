// The measured noise of an emulated receiver against the formulas of its loops.

#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/support/gnss_scene.h"

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
}  // namespace vbar::twins::gnss
