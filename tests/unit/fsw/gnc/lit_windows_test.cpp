// Burns in sunlight: against the shadow of a cylinder on the same orbit, minute by minute.

#include "fsw/gnc/lit_windows.h"

#include <gtest/gtest.h>

#include "fsw/orbit/secular.h"
#include "fsw/orbit/sun.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::gnc {
namespace {

constexpr GpsTime kEpoch{994'986'015LL * kNanosecondsPerSecond};  // 2011-07-18 01:00 UTC
constexpr double kEarthRadius_m = 6.378e6;

bool is_lit(const orbit::QnsElements& mean, double s) {
  const Vector3 sun = orbit::sun_position_gcrf(kEpoch).normalized();
  const Vector3 r = orbit::cartesian_from_qns(orbit::propagate_secular(mean, s)).value().position_eci;
  const double along = r.dot(sun);
  return along > 0.0 || (r - along * sun).norm() > kEarthRadius_m;
}

TEST(LitWindows, AreTheLitPartOfTheOrbitLessItsEdges) {
  const orbit::QnsElements mean = orbit::mission::kServicerMean;  // the printed node: a third of the orbit is dark
  const LitWindows windows(kEpoch, mean);
  int allowed = 0;
  int dark = 0;
  for (int s = 0; s < 6000; s += 10) {
    const bool is_allowed = windows.allows(kEpoch + duration_of_seconds(s));
    // The limb of the on-board shadow differs from this one by the oblateness: some seconds.
    if (!is_lit(mean, s - 30.0) || !is_lit(mean, s) || !is_lit(mean, s + 30.0)) {
      EXPECT_FALSE(is_allowed) << s;
      ++dark;
    }
    bool is_surely_lit = true;
    for (double offset = -150.0; offset <= 90.0; offset += 10.0)
      is_surely_lit = is_surely_lit && is_lit(mean, s + offset);
    if (is_surely_lit) {
      EXPECT_TRUE(is_allowed) << s;
      ++allowed;
    }
  }
  EXPECT_GT(allowed, 200);
  EXPECT_GT(dark, 100);
}

TEST(LitWindows, TheSolverAsksTheSame) {
  const LitWindows windows(kEpoch, orbit::mission::kServicerMean);
  const control::ThrustWindows thrust = windows.thrust_windows();
  for (int s = 0; s < 6000; s += 100) {
    const GpsTime time = kEpoch + duration_of_seconds(s);
    EXPECT_EQ(thrust.allowed(thrust.context, time), windows.allows(time));
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc
