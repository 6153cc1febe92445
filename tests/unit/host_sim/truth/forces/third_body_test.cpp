#include <cmath>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/third_body_force.h"
#include "tests/support/accuracy.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using Wide = boost::multiprecision::cpp_bin_float_50;

const Vector3 kSun(-0.4 * kAstronomicalUnit, 0.85 * kAstronomicalUnit, 0.37 * kAstronomicalUnit);
const Vector3 kMoon(2.9e8, -2.2e8, 1.1e8);
const Vector3 kDirections[] = {{1, 0, 0}, {0, -1, 0}, {0.3, 0.5, -0.7}, {-0.6, 0.1, 0.8}, {2.9, -2.2, 1.1}};

/// The definition: attraction of the spacecraft less that of the Earth, in 50 digits.
Vector3 direct_difference(const Vector3& position, const Vector3& body, double gm) {
  Wide to_body[3], distance2 = 0, body2 = 0;
  for (int i = 0; i < 3; ++i) {
    to_body[i] = Wide(body[i]) - Wide(position[i]);
    distance2 += to_body[i] * to_body[i];
    body2 += Wide(body[i]) * Wide(body[i]);
  }
  const Wide near = Wide(gm) / (distance2 * sqrt(distance2)), far = Wide(gm) / (body2 * sqrt(body2));
  Vector3 difference;
  for (int i = 0; i < 3; ++i) difference[i] = static_cast<double>(near * to_body[i] - far * Wide(body[i]));
  return difference;
}

TEST(ThirdBody, IsTheDirectDifferenceWithoutItsCancellation) {
  // A few roundings of doubles, 1e-15; along directions where the tide's two terms compensate each other, some more.
  accuracy::Largest largest;
  for (const auto& [body, gm] : {std::pair{kSun, kSunGm}, {kMoon, kMoonGm}}) {
    for (const Vector3& direction : kDirections) {
      for (double distance : {1.0, 6.4e6, 7.1e6, 4.2e7, 1.5e8}) {
        const Vector3 position = distance * direction.normalized();
        const Vector3 expected = direct_difference(position, body, gm);
        largest.add((third_body_acceleration(position, body, gm) - expected).norm() / expected.norm());
      }
    }
  }
  accuracy::expect_below("attraction of Sun and Moon", "direct difference in 50 digits, 1 m to 150,000 km", largest,
                         3e-15, "relative");
}

TEST(ThirdBody, IsATideNearTheEarth) {
  // First order in position: GM / d^3 (3 (r . s) s - r); the next order is smaller by 1.5 r / d at most per unit of the
  // tide along s, so 3 r / d bounds it whatever the direction.
  for (const auto& [body, gm] : {std::pair{kSun, kSunGm}, {kMoon, kMoonGm}}) {
    const double d = body.norm();
    const Vector3 s = body / d;
    for (const Vector3& direction : kDirections) {
      const Vector3 r = 7.1e6 * direction.normalized();
      const Vector3 tide = gm / (d * d * d) * (3.0 * r.dot(s) * s - r);
      EXPECT_LT((third_body_acceleration(r, body, gm) - tide).norm(), 3.0 * 7.1e6 / d * tide.norm());
    }
  }
}

TEST(ThirdBody, TakesItsBodyFromTheInput) {
  ForceInput input;
  input.position_eci = Vector3(7.1e6, 1e6, -2e6);
  input.sun_eci = kSun;
  input.moon_eci = kMoon;
  ThirdBodyForce sun(ThirdBodyForce::Body::kSun), moon(ThirdBodyForce::Body::kMoon);
  EXPECT_EQ(sun.acceleration_eci(input), third_body_acceleration(input.position_eci, kSun, kSunGm));
  EXPECT_EQ(moon.acceleration_eci(input), third_body_acceleration(input.position_eci, kMoon, kMoonGm));
  EXPECT_EQ(sun.name(), "sun");
  EXPECT_EQ(moon.name(), "moon");
  EXPECT_TRUE(sun.needs_sun_and_moon() && moon.needs_sun_and_moon());
  // The Moon's tide on the Earth is 2.2 times the Sun's (Newton's tides): the parameters belong to the right bodies.
  const double moon_tide = kMoonGm / std::pow(384400e3, 3), sun_tide = kSunGm / std::pow(kAstronomicalUnit, 3);
  EXPECT_NEAR(moon_tide / sun_tide, 2.18, 0.01);
}

}  // namespace
}  // namespace vbar::truth
