#include "fsw/orbit/gravity_field.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <GeographicLib/SphericalHarmonic.hpp>
#include <gtest/gtest.h>

#include "fsw/orbit/constants.h"
#include "fsw/orbit/gravity_coefficients.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "tests/support/accuracy.h"
#include "tests/support/paths.h"

namespace vbar::fsw::orbit {
namespace {

truth::GravityCoefficients published() {
  return truth::load_gravity_coefficients(vbar::tests::source_path("data/gravity/ggm05s_120.txt"), kGravityDegree);
}

TEST(OnboardGravity, CoefficientsAreThoseOfTheFile) {
  const truth::GravityCoefficients file = published();
  EXPECT_EQ(file.gm, kMu);
  EXPECT_EQ(file.radius, kEarthRadius);
  for (int n = 0; n <= kGravityDegree; ++n) {
    for (int m = 0; m <= n; ++m) {
      EXPECT_EQ(kStokesCoefficients[stokes_index(n, m)].c, file.c_nm(n, m)) << n << " " << m;
      EXPECT_EQ(kStokesCoefficients[stokes_index(n, m)].s, file.s_nm(n, m)) << n << " " << m;
    }
  }
}

TEST(OnboardGravity, AgreesWithGeographicLib) {
  const truth::GravityCoefficients file = published();
  std::vector<double> c, s;
  for (int m = 0; m <= kGravityDegree; ++m) {
    for (int n = m; n <= kGravityDegree; ++n) {
      c.push_back(file.c_nm(n, m));
      if (m > 0) s.push_back(file.s_nm(n, m));
    }
  }
  const GeographicLib::SphericalHarmonic peer(c, s, kGravityDegree, kGravityDegree, kGravityDegree, file.radius);
  std::mt19937_64 random(20);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> distance(6578136.3, 8378136.3);
  accuracy::Largest largest;
  for (int k = 0; k < 10000; ++k) {
    Vector3 r(direction(random), direction(random), direction(random));
    // The poles among them, where longitude is none.
    if (k < 4) r = Vector3(k < 2 ? 0.0 : 1e-9, 0.0, k % 2 == 0 ? 1.0 : -1.0);
    r *= distance(random) / r.norm();
    Vector3 gradient;
    peer(r.x(), r.y(), r.z(), gradient.x(), gradient.y(), gradient.z());
    const Vector3 expected = file.gm / file.radius * gradient;
    largest.add((gravity_itrf(r) - expected).norm() / expected.norm());
  }
  // Rounding of two summations of 253 terms whose sum is a thousandth of the point mass.
  accuracy::expect_below("on-board gravity 20x20", "GeographicLib SphericalHarmonic, 10,000 points", largest, 1e-14,
                         "relative");
}

}  // namespace
}  // namespace vbar::fsw::orbit
