// The measured noise of an emulated receiver against the formulas of its loops.

#include <cmath>
#include <map>

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

}  // namespace
}  // namespace vbar::twins::gnss
