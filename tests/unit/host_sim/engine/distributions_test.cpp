#include "host_sim/engine/distributions.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

TEST(Distributions, UnitIntervalIsOpenAndSymmetric) {
  EXPECT_EQ(open_unit_interval(0), 0x1p-53);
  EXPECT_EQ(open_unit_interval(~std::uint64_t{0}), 1.0 - 0x1p-53);
  const std::uint64_t bits = 0x123456789abcdef0U;
  EXPECT_EQ(open_unit_interval(bits) + open_unit_interval(~bits), 1.0);
}

// Values printed with the algorithm (Wichura 1988, p. 483): quantiles at 0.25, 0.001 and 1e-20, ten digits there; the
// bound is half a unit of the last printed digit.
TEST(Distributions, NormalQuantileGivesThePublishedCheckValues) {
  EXPECT_NEAR(normal_quantile(0.25), -0.6744897501960817, 5e-17 + 2e-16);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167814, 2e-15);
  EXPECT_NEAR(normal_quantile(1e-20), -9.262340089798408, 5e-15);
  EXPECT_EQ(normal_quantile(0.5), 0.0);
}

// The C library's erfc is an independent road back from x to p. p carries a relative rounding error of about eps (1 +
// x^2) through erfc's own argument; 20 of these leave room for erfc's last bits.
TEST(Distributions, NormalQuantileInvertsTheDistributionFunction) {
  for (double x = -8.0; x <= 0.0; x += 0.01) {
    const double p = 0.5 * std::erfc(-x / std::sqrt(2.0));
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * 3.14159265358979323846);
    EXPECT_NEAR(normal_quantile(p), x, 20.0 * 2.2e-16 * (1.0 + x * x) * p / density + 1e-15) << x;
  }
}

TEST(Distributions, NormalQuantileIsAntisymmetricAndRefusesWhatIsNoProbability) {
  for (const double p : {0.001, 0.07, 0.075, 0.2, 0.4})  // both sides of the switch at 0.075
    EXPECT_NEAR(normal_quantile(p) + normal_quantile(1.0 - p), 0.0,
                1e-13);  // 1 - p rounds: eps p/density(0.001) < 1e-13
  for (const double p : {0.0, 1.0, -0.1, 1.1, std::nan("")}) EXPECT_TRUE(std::isnan(normal_quantile(p)));
}

// A standard normal cut off at [a, b] has the distribution function (Phi(x) - Phi(a)) / (Phi(b) - Phi(a)).
TEST(Distributions, TruncatedNormalFollowsItsDistributionFunction) {
  const double intervals[][2] = {{-1.0, 2.0}, {-8.0, -1.0}, {0.5, 3.0}, {5.0, 6.0}, {-40.0, 40.0}};
  for (const auto& [low, high] : intervals) {
    for (const double p : {0.001, 0.1, 0.5, 0.9, 0.999}) {
      const double x = truncated_normal_quantile(p, low, high);
      EXPECT_GE(x, low);
      EXPECT_LE(x, high);
      // Upper tails from above: 1 - Phi is Phi(-x), without cancellation.
      const double above = normal_distribution(-x) - normal_distribution(-high);
      const double all = normal_distribution(-low) - normal_distribution(-high);
      EXPECT_NEAR(above / all, 1.0 - p, 1e-11) << low << ' ' << high << ' ' << p;  // eps * 1/density in the far tail
    }
  }
}

TEST(Distributions, TruncatedNormalStaysInsideWhereNoProbabilityIsLeft) {
  EXPECT_EQ(truncated_normal_quantile(0.5, 60.0, 61.0), 60.0);
  EXPECT_EQ(truncated_normal_quantile(0.5, -61.0, -60.0), -60.0);
  // p so close to 1 that the sum rounds to 1: a large finite number, not an infinity.
  const double x = truncated_normal_quantile(1.0 - 0x1p-53, 0.0, 100.0);
  EXPECT_GT(x, 8.0);
  EXPECT_LT(x, 9.0);
}

TEST(Distributions, ExponentialIsItsInverse) {
  EXPECT_DOUBLE_EQ(exponential_upper_quantile(std::exp(-2.0)), 2.0);
  EXPECT_NEAR(exponential_upper_quantile(open_unit_interval(0)), 53.0 * std::log(2.0), 1e-13);
}

}  // namespace
}  // namespace vbar::engine
