#include "host_sim/truth/atmosphere/effective_ap.h"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace vbar::truth {
namespace {

/// Coefficients that bend nothing: the effective ap is linear in the history.
Nrlmsise00Tables::Upper linear_coefficients(double fading_per_s) {
  Nrlmsise00Tables::Upper p{};
  p[24] = p[43] = 0.08;
  p[25] = p[44] = 1.0;
  p[51] = fading_per_s;
  return p;
}

SolarIndices quiet_history() {
  SolarIndices indices;
  indices.geomagnetic_index = GeomagneticIndex::kThreeHourly;
  indices.ap_history.fill(4.0);
  return indices;
}

TEST(EffectiveAp, ForgetsGeometricallyByThreeHours) {
  // Hedin (1987), eq. A24: sum of e^k ap_k over the 20 intervals of the last 57 hours, over 1 + sqrt(e) (sum of e^k, 19
  // of them); here term by term, where a mean of eight stands for each of its eight intervals.
  const double fading_per_s = 3.0e-5;
  const double e = std::exp(-10800.0 * fading_per_s);
  for (std::size_t pulse = 0; pulse < 6; ++pulse) {
    SolarIndices indices = quiet_history();
    indices.ap_history[pulse] = 104.0;
    double sum = 0.0, norm = 1.0;
    for (int k = 0; k < 20; ++k) {
      const std::size_t entry = k < 4 ? static_cast<std::size_t>(k) : (k < 12 ? 4 : 5);
      sum += std::pow(e, k) * (indices.ap_history[entry] - 4.0);
      if (k < 19) norm += std::sqrt(e) * std::pow(e, k);
    }
    const EffectiveAp ap(linear_coefficients(fading_per_s), indices);
    EXPECT_NEAR(ap.at(45.0), sum / norm, 1e-12 * sum);  // rounding of twenty terms
  }
}

TEST(EffectiveAp, QuietIsZero) {
  const EffectiveAp remembered(linear_coefficients(3e-5), quiet_history());
  EXPECT_EQ(remembered.at(10.0), 0.0);
  SolarIndices daily;
  daily.ap_daily = 4.0;
  EXPECT_EQ(EffectiveAp(linear_coefficients(3e-5), daily).at(10.0), 0.0);
}

TEST(EffectiveAp, MemoryIsShorterTowardsThePoleIfTheCoefficientSaysSo) {
  Nrlmsise00Tables::Upper p = linear_coefficients(3e-5);
  p[138] = 3e-3;
  SolarIndices indices = quiet_history();
  indices.ap_history[3] = 104.0;
  const EffectiveAp ap(p, indices);
  const double at_45 = EffectiveAp(linear_coefficients(3e-5), indices).at(45.0);
  EXPECT_NEAR(ap.at(45.0), at_45, 1e-12 * at_45);
  EXPECT_LT(ap.at(80.0), ap.at(45.0));
  EXPECT_EQ(ap.at(-80.0), ap.at(80.0));
}

TEST(EffectiveAp, SaturatesFromSlopeOneToItsLimit) {
  // ap' - 4 = x + (b - 1)(x + (exp(-a x) - 1)/a): slope 1 at x = 0, b far above (Hedin 1987, eq. A24b).
  Nrlmsise00Tables::Upper p{};
  p[43] = 0.08;
  p[44] = 0.2;
  const auto effective = [&](double ap) {
    SolarIndices indices;
    indices.ap_daily = ap;
    return EffectiveAp(p, indices).at(0.0);
  };
  EXPECT_NEAR((effective(4.001) - effective(3.999)) / 0.002, 1.0, 1e-6);  // curvature over 0.001
  EXPECT_NEAR((effective(401.0) - effective(399.0)) / 2.0, 0.2, 1e-9);    // exp(-30)
  EXPECT_NEAR(effective(400.0), 396.0 + (0.2 - 1.0) * (396.0 - 1.0 / 0.08), 1e-9);
}

}  // namespace
}  // namespace vbar::truth
