#include "host_sim/truth/forces/solid_tides_force.h"

#include <cmath>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;

class SolidTidesForceTest : public testing::Test {
 protected:
  SolidTidesForce force(TideSystem system) const {
    return {test::kGm, test::kEarthRadius, system, test::mission_epoch(), orientation_};
  }

  ForceInput input(double seconds, const Vector3& position_eci) const {
    EarthRotation rotation(orientation_, test::mission_epoch());
    const SunMoon bodies = sun_moon_series(tt_of(test::mission_epoch(), seconds));
    ForceInput in;
    in.seconds = seconds;
    in.position_eci = position_eci;
    in.R_itrf_gcrf = rotation.R_itrf_gcrf_at(seconds);
    in.position_itrf = in.R_itrf_gcrf * position_eci;
    in.sun_eci = bodies.sun_eci;
    in.moon_eci = bodies.moon_eci;
    return in;
  }

  std::shared_ptr<const EarthOrientationSeries> orientation_ = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv"));
};

TEST_F(SolidTidesForceTest, IsAboutATenMillionthOfAMetrePerSecondSquaredUnderTheMoon) {
  // Degree 2 alone, under the Moon: 3 k2 GM_moon/d^3 (R/r)^5 r, with the Sun's half as much again at most; the Sun's
  // share may also take half away.
  SolidTidesForce tides = force(TideSystem::kTideFree);
  const SunMoon bodies = sun_moon_series(tt_of(test::mission_epoch()));
  const Vector3 r = 6.85e6 * bodies.moon_eci.normalized();
  const double moon = 3.0 * 0.30 * 0.0123 * test::kGm / std::pow(bodies.moon_eci.norm(), 3) *
                      std::pow(test::kEarthRadius / r.norm(), 5) * r.norm();
  const Vector3 a = tides.acceleration_eci(input(0.0, r));
  EXPECT_GT(a.norm(), 0.5 * moon);
  EXPECT_LT(a.norm(), 1.5 * moon);
  EXPECT_LT(a.dot(r), 0.0);  // over a bulge gravity is stronger
}

TEST_F(SolidTidesForceTest, AZeroTideModelHasThePermanentPartAlready) {
  SolidTidesForce zero = force(TideSystem::kZeroTide), free = force(TideSystem::kTideFree);
  const ForceInput in = input(1000.0, Vector3(6.85e6, 0.0, 0.0));
  const LowDegreeCoefficients a = zero.coefficients(in), b = free.coefficients(in);
  // IERS Conventions 2010, section 6.2.2: 4.4228e-8 x 0.31460 x 0.30190, five digits.
  EXPECT_NEAR(a.c[2][0] - b.c[2][0], 4.2007e-9, 5e-14);
  EXPECT_EQ(a.c[2][1], b.c[2][1]);
  EXPECT_EQ(a.s[2][2], b.s[2][2]);
}

TEST_F(SolidTidesForceTest, IsSmooth) {
  // Across the hour at which the slow sums' cubic changes: second differences over 1 s as before and after it.
  SolidTidesForce tides = force(TideSystem::kZeroTide);
  const Vector3 r(1e6, -6e6, 3e6);
  const double hour = 3600.0 - 66.184;  // an hour of TT after 01:00 UTC
  const auto bend = [&](double t) {
    return (tides.acceleration_eci(input(t + 1.0, r)) - 2.0 * tides.acceleration_eci(input(t, r)) +
            tides.acceleration_eci(input(t - 1.0, r)))
        .norm();
  };
  // 1e-7 m/s^2 turning once a day: (7e-5)^2 of it, 5e-16; rounding of differences of 1e-7: 1e-22.
  EXPECT_LT(bend(hour), 2.0 * bend(hour - 600.0) + 1e-21);
}

TEST_F(SolidTidesForceTest, RefusesWhatItHasNoDataFor) {
  EXPECT_THROW(SolidTidesForce(test::kGm, test::kEarthRadius, TideSystem::kZeroTide, test::mission_epoch(), nullptr),
               std::invalid_argument);
  SolidTidesForce tides = force(TideSystem::kZeroTide);
  ForceInput in = input(0.0, Vector3(6.85e6, 0.0, 0.0));
  in.seconds = 1e9;
  EXPECT_THROW(static_cast<void>(tides.acceleration_eci(in)), std::out_of_range);
}

}  // namespace
}  // namespace vbar::truth
