#include "host_sim/truth/forces/low_degree_field.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "host_sim/truth/forces/gravity_field.h"

namespace vbar::truth {
namespace {

TEST(LowDegreeField, IsTheGravityFieldOfTheSameCoefficients) {
  // gravity_field.h, which agrees with an independent program, sums other recursions of the same series.
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    LowDegreeCoefficients low;
    GravityCoefficients field;
    field.gm = 3.986004415e14;
    field.radius = 6378136.3;
    field.degree = 4;
    field.c.assign(GravityCoefficients::index(5, 0), 0.0);
    field.s = field.c;
    for (int n = 2; n <= 4; ++n) {
      for (int m = 0; m <= n; ++m) {
        field.c[GravityCoefficients::index(n, m)] = low.c[n][m] = 1e-9 * normal(random);
        if (m > 0) field.s[GravityCoefficients::index(n, m)] = low.s[n][m] = 1e-9 * normal(random);
      }
    }
    const GravityField reference(field, 4, 4);
    const fsw::Vector3 r = 6.9e6 * fsw::Vector3(normal(random), normal(random), normal(random)).normalized();
    const fsw::Vector3 expected = reference.perturbation_itrf(r);
    // Rounding of some thirty terms.
    EXPECT_LT((acceleration_itrf(low, field.gm, field.radius, r) - expected).norm(), 1e-14 * expected.norm());
  }
}

TEST(LowDegreeField, HasNoSingularityAtThePoles) {
  LowDegreeCoefficients field;
  field.c[2][1] = 1e-9;
  field.s[3][1] = -2e-9;
  const fsw::Vector3 at_pole = acceleration_itrf(field, 4e14, 6.4e6, {0.0, 0.0, 7e6});
  const fsw::Vector3 beside = acceleration_itrf(field, 4e14, 6.4e6, {1e-3, 0.0, 7e6});
  EXPECT_GT(at_pole.norm(), 1e-9);
  EXPECT_LT((at_pole - beside).norm(), 1e-9 * at_pole.norm());  // a millimetre of 7000 km, times the degree
}

}  // namespace
}  // namespace vbar::truth
