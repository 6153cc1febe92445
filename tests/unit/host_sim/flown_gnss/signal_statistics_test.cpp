// Noise by elevation from simulated observations: noise of known size comes out again, geometry, clocks and ionosphere
// do not.

#include "host_sim/flown_gnss/signal_statistics.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host_sim/flown_gnss/orbit_errors.h"

namespace vbar::flown_gnss {
namespace {

using fsw::gnss::Signal;

/// Epochs of one satellite for two hours, 10 s apart; code noise of 0.5 m on L1, whose correlation in time is
/// `correlation` from one epoch to the next, and 1 mm on each carrier. `step_m`: of L1 halfway.
SignalStatistics statistics(double correlation, double step_m = 0.0) {
  constexpr double kGamma = (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz) * (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz);
  constexpr int kEpochs = 720;
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  SignalStatistics statistics(10.0);
  double code_m = 0.5 * normal(engine);
  for (int k = 0; k < kEpochs; ++k) {
    const double t = 10.0 * k, range_m = 2.2e7 + 900.0 * t - 0.1 * t * t, ionosphere_m = 3.0 + std::sin(1e-3 * t);
    code_m = correlation * code_m + std::sqrt(1.0 - correlation * correlation) * 0.5 * normal(engine);
    fsw::gnss::ObservationEpoch epoch;
    epoch.receiver_time = fsw::GpsTime{} + fsw::duration_of_seconds(1'000'000'000 + 10 * k);
    epoch.count = 2;
    for (int place = 0; place < 2; ++place) {
      const Signal signal = place == 0 ? Signal::kGpsL1 : Signal::kGpsL2;
      const double delay_m = place == 0 ? ionosphere_m : kGamma * ionosphere_m;
      fsw::gnss::Observation& one = epoch.observations[static_cast<std::size_t>(place)];
      one.satellite = {fsw::gnss::Constellation::kGps, 7};
      one.signal = signal;
      one.phase_usable = true;
      one.pseudorange_m = range_m + delay_m + (place == 0 ? code_m : 0.0);
      const double slip_m = place == 0 && k >= kEpochs / 2 ? step_m : 0.0;
      one.carrier_phase_cycles =
          (range_m - delay_m + slip_m + 1e-3 * normal(engine)) / fsw::gnss::wavelength(signal) + 1234.0;
      one.lock_time_s = t + 1.0;
    }
    statistics.add(epoch, [](fsw::gnss::SatelliteId) { return 0.6; });
  }
  statistics.finish();
  return statistics;
}

TEST(SignalStatistics, FindTheNoiseAgain) {
  const SignalStatistics white = statistics(0.0);
  const std::size_t bin = bin_of(0.6);
  EXPECT_EQ(white.arcs(), 1U);
  EXPECT_EQ(white.steps(), 0U);
  EXPECT_EQ(white.code_l1().bins[bin].count, 720U);
  // 720 values: a standard deviation is found to 2.6 %, 4 sigma; the carriers' third differences are correlated.
  EXPECT_NEAR(white.code_l1().bins[bin].sigma(), 0.5, 0.055);
  EXPECT_NEAR(white.carrier()[bin].sigma(), std::sqrt(2.0) * 1e-3, 0.2e-3);
  EXPECT_NEAR(white.code_l1().correlation.at(1), 0.0, 4.0 / std::sqrt(720.0));
  // exp(-1/6): a correlation time of six epochs.
  const SignalStatistics correlated = statistics(std::exp(-1.0 / 6.0));
  ASSERT_TRUE(correlated.code_l1().correlation.time().has_value());
  EXPECT_NEAR(*correlated.code_l1().correlation.time(), 6.0, 2.5);
}

TEST(SignalStatistics, CountAStepOfACarrier) {
  EXPECT_EQ(statistics(0.0, fsw::gnss::wavelength(Signal::kGpsL1)).steps(), 1U);
}

/// The constant of the flight software, 1e-9 m^2/s^3, is that of the missions' orbit, 7087 km, to a factor of two.
TEST(OmittedGravity, IsTheProcessNoiseAtTheMissionsOrbit) {
  const double psd = fsw::filter::AbsoluteOrbitSettings{}.acceleration_psd;
  EXPECT_GT(omitted_gravity_psd(7087.3e3), 0.5 * psd);
  EXPECT_LT(omitted_gravity_psd(7087.3e3), 2.0 * psd);
  EXPECT_GT(omitted_gravity_psd(6838e3), 6.0 * omitted_gravity_psd(7087.3e3));
}

}  // namespace
}  // namespace vbar::flown_gnss
