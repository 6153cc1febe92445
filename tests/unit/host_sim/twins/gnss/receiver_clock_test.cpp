#include "host_sim/twins/gnss/receiver_clock.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::twins::gnss {
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
}  // namespace vbar::twins::gnss
