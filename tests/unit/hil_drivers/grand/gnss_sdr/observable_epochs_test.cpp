#include "hil_drivers/grand/bench/samples/gnss_sdr/observable_epochs.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::grand::bench {
namespace {

constexpr double kWavelength_m = 299792458.0 / 1575.42e6;

Observable observable(int channel, int prn, double rx_time_s) {
  return {.channel = channel,
          .prn = prn,
          .rx_time_s = rx_time_s,
          .valid = prn != 0,
          .pseudorange_m = 2.1e7,
          .carrier_phase_cycles = 1000.25,
          .doppler_hz = 0.0,
          .cn0_dbhz = 45.0};
}

TEST(ObservableEpochs, AnEpochIsCompleteWithAllChannels) {
  ObservableEpochs epochs(3, 100);
  epochs.take(observable(1, 19, 1000.0));
  epochs.take(observable(0, 6, 1000.0));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(2, 0, 1000.0));
  const auto epoch = epochs.next();
  ASSERT_TRUE(epoch);
  EXPECT_EQ(epoch->rx_time_ms, 1'000'000);
  ASSERT_EQ(epoch->satellites.size(), 2U);
  EXPECT_EQ(epoch->satellites[0].observable.prn, 6);
  EXPECT_EQ(epoch->satellites[1].observable.prn, 19);
}

// The fraction of the phase is kept; the whole cycles added make it the pseudorange's to half a cycle.
TEST(ObservableEpochs, PhaseIsNearThePseudorangeByWholeCycles) {
  ObservableEpochs epochs(1, 100);
  epochs.take(observable(0, 6, 1000.0));
  const auto epoch = epochs.next();
  ASSERT_TRUE(epoch);
  const double cycles = epoch->satellites[0].carrier_phase_cycles;
  EXPECT_NEAR(cycles, 2.1e7 / kWavelength_m, 0.5);
  EXPECT_NEAR(cycles - std::floor(cycles), 0.25, 1e-7);
}

TEST(ObservableEpochs, ALostDatagramDelaysItsEpochByHalfASecond) {
  ObservableEpochs epochs(2, 100);
  epochs.take(observable(0, 6, 1000.0));
  for (int k = 1; k < 5; ++k) {
    epochs.take(observable(0, 6, 1000.0 + 0.1 * k));
    epochs.take(observable(1, 19, 1000.0 + 0.1 * k));
    EXPECT_FALSE(epochs.next()) << k;
  }
  epochs.take(observable(0, 6, 1000.5));
  for (int k = 0; k < 5; ++k) {
    const auto epoch = epochs.next();
    ASSERT_TRUE(epoch) << k;
    EXPECT_EQ(epoch->rx_time_ms, 1'000'000 + 100 * k);
  }
}

TEST(ObservableEpochs, LockTimeRestartsAfterAGapAndOnAnotherChannel) {
  ObservableEpochs epochs(1, 100);
  const auto locked_since = [&epochs](int channel, double rx_time_s) {
    epochs.take(observable(channel, 6, rx_time_s));
    return epochs.next()->satellites[0].locked_ms;
  };
  EXPECT_EQ(locked_since(0, 1000.0), 1'000'000);
  EXPECT_EQ(locked_since(0, 1000.1), 1'000'000);
  EXPECT_EQ(locked_since(0, 1000.3), 1'000'300);
  EXPECT_EQ(locked_since(3, 1000.4), 1'000'400);
}

TEST(ObservableEpochs, LateAndUnsetTimesAreIgnoredAndAWeekBegins) {
  ObservableEpochs epochs(1, 100);
  epochs.take(observable(0, 6, 0.0));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(0, 6, 604799.9));
  EXPECT_TRUE(epochs.next());
  epochs.take(observable(0, 6, 604799.8));
  EXPECT_FALSE(epochs.next());
  epochs.take(observable(0, 6, 0.1));
  ASSERT_TRUE(epochs.next());
}

}  // namespace
}  // namespace vbar::grand::bench
