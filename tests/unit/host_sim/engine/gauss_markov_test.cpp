#include "host_sim/engine/gauss_markov.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

using fsw::duration_of_seconds;
using fsw::GpsTime;

constexpr double kSigmas = 4.5;

// Autocorrelation of 0.7^2 exp(-dt / 60) at 0, 10, 60 and 600 s, over independent processes; the sample covariance of a
// Gaussian pair scatters with sqrt((1 + r^2) / n) of the variance.
TEST(GaussMarkov, HasItsAutocorrelation) {
  constexpr int kProcesses = 20000;
  constexpr double kSigma = 0.7, kTime_s = 60.0;
  constexpr int kLags_s[] = {0, 10, 60, 600};
  double sums[4] = {};
  for (int k = 0; k < kProcesses; ++k) {
    GaussMarkov process(kSigma, kTime_s, RandomStream(static_cast<std::uint64_t>(k), "process"));
    const double first = process.at(GpsTime{});
    for (std::size_t n = 0; n < 4; ++n) sums[n] += first * process.at(GpsTime{} + duration_of_seconds(kLags_s[n]));
  }
  for (std::size_t n = 0; n < 4; ++n) {
    const double correlation = std::exp(-kLags_s[n] / kTime_s);
    EXPECT_NEAR(sums[n] / kProcesses / (kSigma * kSigma), correlation,
                kSigmas * std::sqrt((1.0 + correlation * correlation) / kProcesses))
        << kLags_s[n] << " s";
  }
}

// The mean square increment over a short time is 2 sigma^2 (1 - exp(-dt / T)): 2 sigma^2 dt / T to 0.01 %.
TEST(GaussMarkov, ShortStepsKeepTheirIncrement) {
  constexpr int kSteps = 100000;
  GaussMarkov process(1.0, 1e5, RandomStream(3, "steps"));
  double before = process.at(GpsTime{});
  double sum = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    const double now = process.at(GpsTime{} + duration_of_seconds(10 * k));
    sum += (now - before) * (now - before);
    before = now;
  }
  EXPECT_NEAR(sum / kSteps / 2e-4, 1.0, kSigmas * std::sqrt(2.0 / kSteps) + 1e-4);
}

TEST(GaussMarkov, RepeatsAValueAndIsZeroWithoutSigma) {
  GaussMarkov process(2.0, 10.0, RandomStream(1, "repeated"));
  const double first = process.at(GpsTime{1000});
  EXPECT_EQ(first, 2.0 * RandomStream(1, "repeated").normal());  // stationary from the start
  EXPECT_EQ(process.at(GpsTime{1000}), first);
  EXPECT_EQ(process.at(GpsTime{500}), first);
  EXPECT_NE(process.at(GpsTime{1000} + duration_of_seconds(1)), first);
  GaussMarkov none(0.0, 10.0, RandomStream(1, "none"));
  EXPECT_EQ(none.at(GpsTime{1000}), 0.0);
}

}  // namespace
}  // namespace vbar::engine
