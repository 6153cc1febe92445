#include "fsw/navigation/adaptive_noise.h"

#include <gtest/gtest.h>

#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::navigation {
namespace {

constexpr AdaptiveNoiseSettings kSettings{.psd = 1e-13, .psd_min = 1e-14, .psd_max = 1e-11};

/// First-order correlated pairs, as a filter that lags leaves them. `scale`: their standard deviation.
void feed(AdaptiveNoise& noise, double correlation, double scale, int count, bool interrupted = false,
          AdaptiveNoise::Correlation cause = AdaptiveNoise::Correlation::kOfLag) {
  test::Noise random(3);
  Vector2 value = random.normal2();
  for (int k = 0; k < count; ++k) {
    value = correlation * value + std::sqrt(1.0 - correlation * correlation) * random.normal2();
    noise.add(scale * value, cause);
    if (interrupted && k % 20 == 19) noise.interrupt();
  }
}

TEST(AdaptiveNoise, RisesToItsBoundWhereInnovationsAreCorrelated) {
  AdaptiveNoise noise(kSettings);
  feed(noise, 0.7, 1.5, 200);
  EXPECT_EQ(noise.psd(), kSettings.psd_max);
}

TEST(AdaptiveNoise, FallsToItsBoundWhereTheyAreWhiteEvenIfTheyAreLarge) {
  for (const double scale : {1.0, 3.0}) {
    AdaptiveNoise noise(kSettings);
    feed(noise, 0.0, scale, 1000);
    EXPECT_EQ(noise.psd(), kSettings.psd_min);
  }
}

TEST(AdaptiveNoise, AWindowThatIsInterruptedSaysNothing) {
  AdaptiveNoise noise(kSettings);
  feed(noise, 0.9, 1.5, 400, true);  // 19 pairs between interruptions, fewer than a window
  EXPECT_EQ(noise.psd(), kSettings.psd);
}

TEST(AdaptiveNoise, CorrelatedErrorsOfTheMeasurementsAreNoReasonForMore) {
  AdaptiveNoise noise(kSettings);
  feed(noise, 0.9, 1.5, 400, false, AdaptiveNoise::Correlation::kOfEither);
  EXPECT_EQ(noise.psd(), kSettings.psd);
  feed(noise, 0.2, 1.5, 1000, false, AdaptiveNoise::Correlation::kOfEither);
  EXPECT_EQ(noise.psd(), kSettings.psd_min);
}

}  // namespace
}  // namespace vbar::fsw::navigation
