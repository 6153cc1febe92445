#include "host_sim/twins/gnss/signal_noise.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace vbar::twins::gnss {
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
