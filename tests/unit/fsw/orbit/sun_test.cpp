#include "fsw/orbit/sun.h"

#include <algorithm>
#include <cmath>

#include <erfa.h>
#include <erfam.h>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::fsw::orbit {
namespace {

struct Earth {
  Vector3 sun_position;     ///< m
  Vector3 velocity_over_c;  ///< barycentric
};

Earth erfa_earth(GpsTime time) {
  double heliocentric[2][3], barycentric[2][3];
  eraEpv00(2444244.5, (static_cast<double>(time.ns) / 1e9 + 51.184) / 86400.0, heliocentric, barycentric);
  constexpr double kLightDay_au = 299'792'458.0 * 86400.0 / ERFA_DAU;
  return {Vector3(heliocentric[0][0], heliocentric[0][1], heliocentric[0][2]) * -ERFA_DAU,
          Vector3(barycentric[1][0], barycentric[1][1], barycentric[1][2]) / kLightDay_au};
}

TEST(OnboardSun, AgreesWithErfaFrom2000To2040) {
  constexpr std::int64_t kFirst_s = 7300LL * 86400;
  accuracy::Largest direction, distance, velocity;
  for (int step = 0; step < 4800; ++step) {
    const GpsTime time{(kFirst_s + step * 263'000LL) * kNanosecondsPerSecond};
    const Earth expected = erfa_earth(time);
    const Vector3 sun = sun_position_gcrf(time);
    direction.add((sun.normalized() - expected.sun_position.normalized()).norm() / ERFA_DAS2R);
    distance.add(std::abs(sun.norm() / expected.sun_position.norm() - 1.0));
    velocity.add((earth_velocity_over_c_gcrf(time) - expected.velocity_over_c).norm());
  }
  // What the header promises: terms left out, together.
  accuracy::expect_below("on-board Sun, direction 2000 to 2040", "ERFA eraEpv00, 4800 instants", direction, 15.0,
                         "arcsec");
  EXPECT_LT(distance, 1e-4);
  accuracy::expect_below("on-board aberration by the Earth's motion 2000 to 2040", "ERFA eraEpv00, 4800 instants",
                         velocity / ERFA_DAS2R, 0.006, "arcsec");
}

TEST(OnboardSun, EarthMovesAcrossTheSunsDirectionWithTheConstantOfAberration) {
  // 20.49552 arcsec (IAU 1976) is the speed on a circle; the ellipse adds and takes 1.7 per cent.
  for (int month = 0; month < 12; ++month) {
    const GpsTime time{(11500LL + 30 * month) * 86400 * kNanosecondsPerSecond};
    const Vector3 velocity = earth_velocity_over_c_gcrf(time);
    EXPECT_NEAR(velocity.norm() / ERFA_DAS2R, 20.4955, 0.36);
    EXPECT_NEAR(velocity.normalized().dot(sun_position_gcrf(time).normalized()), 0.0, 0.018);
  }
}

}  // namespace
}  // namespace vbar::fsw::orbit
