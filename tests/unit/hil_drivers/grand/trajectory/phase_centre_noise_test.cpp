// The noise of the phase centre: at the receiver's epochs independent normal values, between them a curve without steps
// in position, velocity and acceleration.

#include "hil_drivers/grand/trajectory/phase_centre_noise.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fsw/core/gps_time.h"

namespace vbar::grand::test {
namespace {

using fsw::Vector3;

constexpr fsw::GpsTime kEpoch{(std::int64_t{1'000'000} * 10 + 9) * fsw::kNanosecondsPerSecond};

PhaseCentreNoise noise(std::uint64_t seed = 3) {
  return {1e-3, {}, seed, "servicer"};
}

TEST(PhaseCentreNoise, HasTheGivenSigmaAndIsIndependentFromEpochToEpoch) {
  PhaseCentreNoise source = noise();
  constexpr int kEpochs = 20000;
  Vector3 square = Vector3::Zero();
  double product = 0.0;
  Vector3 previous = Vector3::Zero();
  for (int k = 0; k < kEpochs; ++k) {
    const Vector3 value = source.at(kEpoch + fsw::duration_of_seconds(10 * k))[0];
    square += value.cwiseAbs2();
    product += value.dot(previous);
    previous = value;
  }
  // Relative standard error of a variance from n values: sqrt(2/n) = 1 %; of a correlation over 3n products:
  // 1/sqrt(3n) = 0.4 %. Four of each.
  for (const double sum : square) EXPECT_NEAR(sum / kEpochs / 1e-6, 1.0, 0.04);
  EXPECT_NEAR(product / square.sum(), 0.0, 0.016);
}

TEST(PhaseCentreNoise, HasNoStepsAtAnEpochAndRestsThere) {
  PhaseCentreNoise source = noise();
  const fsw::Duration instant{1};
  const auto before = source.at(kEpoch - instant);
  const auto at = source.at(kEpoch);
  const auto after = source.at(kEpoch + instant);
  // A nanosecond at the largest velocity, acceleration and jerk of a step of some millimetres in 10 s.
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((at[k] - before[k]).norm(), 1e-11) << k;
    EXPECT_LT((after[k] - at[k]).norm(), 1e-11) << k;
  }
  EXPECT_EQ(at[1].norm(), 0.0);
  EXPECT_EQ(at[2].norm(), 0.0);
  EXPECT_GT(at[0].norm(), 0.0);
}

TEST(PhaseCentreNoise, DerivativesAreThoseOfTheCurve) {
  PhaseCentreNoise source = noise();
  const fsw::Duration h{10'000'000};
  for (int epoch = 0; epoch < 3; ++epoch) {
    // Not at the epochs themselves, where the third derivative jumps.
    for (std::int64_t tenth = 1; tenth < 100; ++tenth) {
      const fsw::GpsTime t = kEpoch + fsw::duration_of_seconds(10 * epoch) + fsw::Duration{tenth * 100'000'000};
      const auto low = source.at(t - h);
      const auto high = source.at(t + h);
      const auto here = source.at(t);
      // Differences err by h^2/6 of the third derivative after the one in question, at most 5e-3 m * 720/10^4..5.
      for (int d = 0; d < 3; ++d)
        EXPECT_LT(((high[d] - low[d]) / 0.02 - here[d + 1]).norm(), 1e-8) << epoch << ' ' << tenth << ' ' << d;
    }
  }
}

// The same instants give the same values in any order, so that a run does not depend on which samples were sent.
TEST(PhaseCentreNoise, DependsOnTheTimeOnly) {
  PhaseCentreNoise forward = noise(), jumping = noise();
  std::vector<Vector3> values;
  for (std::int64_t k = 0; k < 50; ++k) values.push_back(forward.at(kEpoch + fsw::Duration{k * 700'000'000})[0]);
  for (std::int64_t k = 49; k >= 0; --k)
    EXPECT_EQ(jumping.at(kEpoch + fsw::Duration{k * 700'000'000})[0], values[static_cast<std::size_t>(k)]);
  EXPECT_NE(noise(4).at(kEpoch)[0], values[0]);
}

TEST(PhaseCentreNoise, RefusesAPeriodThatIsNotPositive) {
  EXPECT_THROW(PhaseCentreNoise(1e-3, {fsw::Duration{0}, fsw::Duration{0}}, 1, "servicer"), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::grand::test
