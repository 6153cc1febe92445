#include "host_sim/twins/gnss/klobuchar.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fsw/gnss/constants.h"
#include "tests/support/accuracy.h"
#include "tests/support/figures.h"

namespace vbar::twins::gnss {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
constexpr KlobucharCoefficients kExample{{3.82e-8, 1.49e-8, -1.79e-7, 0.0}, {1.43e5, 0.0, -3.28e5, 1.13e5}};

// The worked example that goes with many receivers' manuals (Klobuchar's own coefficients of a winter day): latitude 40
// deg, longitude 260 deg east, elevation 20, azimuth 210 deg, 20:45 UT: 23.784 m. Printed to a millimetre.
TEST(Klobuchar, WorkedExample) {
  const double delay_m = klobuchar_delay_m(kExample, 40.0 * kRadPerDegree, 260.0 * kRadPerDegree, 20.0 * kRadPerDegree,
                                           210.0 * kRadPerDegree, 593100.0);
  accuracy::expect_below("Klobuchar delay on the ground", "worked example, 23.784 m", std::abs(delay_m - 23.784), 5e-4,
                         "m");
}

// Shares of the electron content above 350, 500 and 709 km and the shell over 709 km, computed by hand from Montenbruck
// and Gill 2002 to the digits given.
TEST(Klobuchar, ShareAboveAnOrbit) {
  EXPECT_NEAR(electron_content_above(350e3), 0.8665, 5e-5);
  EXPECT_NEAR(electron_content_above(500e3), 0.362, 5e-4);
  EXPECT_NEAR(electron_content_above(709e3), 0.0541, 5e-5);
  EXPECT_DOUBLE_EQ(electron_content_above(0.0), 1.0);
  EXPECT_NEAR(shell_altitude_m(709e3), 779.7e3, 50.0);
}

// Straight up from an orbit the delay is the vertical one times the share; a ray along the horizontal crosses the shell
// at the angle whose sine is the ratio of the radii.
TEST(Klobuchar, SlantInOrbit) {
  const double radius_m = 6371e3 + 709e3;
  const fsw::Vector3 position(radius_m, 0.0, 0.0);
  const double vertical_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 50400.0) * electron_content_above(709e3);
  EXPECT_NEAR(klobuchar_delay_in_orbit_m(kExample, position, fsw::Vector3::UnitX(), 50400.0), vertical_m, 1e-12);
  const double shell_m = 6371e3 + shell_altitude_m(709e3);
  const double pierce_longitude = std::acos(radius_m / shell_m);
  const double at_pierce_m = klobuchar_vertical_delay_m(kExample, 0.0, pierce_longitude, 50400.0);
  const double slant = 1.0 / std::sqrt(1.0 - radius_m * radius_m / (shell_m * shell_m));
  EXPECT_NEAR(klobuchar_delay_in_orbit_m(kExample, position, fsw::Vector3::UnitY(), 50400.0),
              at_pierce_m * electron_content_above(709e3) * slant, 1e-9);
}

// Over a day in steps of 0.1 s, in which a low orbit moves by less than a kilometre: no step. The series of the cosine
// has a slope of 1 per radian at most.
TEST(Klobuchar, VerticalDelayIsContinuous) {
  const double amplitude_m = fsw::gnss::kSpeedOfLight * kExample.alpha[0];
  double last_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 0.0);
  accuracy::Largest largest_m;
  accuracy::Smallest lowest_m;
  for (int tenths = 1; tenths < 864000; ++tenths) {
    const double delay_m = klobuchar_vertical_delay_m(kExample, 0.0, 0.0, 0.1 * tenths);
    largest_m.add(std::abs(delay_m - last_m));
    lowest_m.add(delay_m);
    last_m = delay_m;
  }
  EXPECT_LT(largest_m, 2.0 * amplitude_m * 2.0 * std::numbers::pi * 0.1 / 72000.0);
  EXPECT_GE(lowest_m, fsw::gnss::kSpeedOfLight * 5e-9 * (1.0 - 1e-12));
}

// From the ground the thin shell and the broadcast obliquity factor are two forms of one mapping: above 30 deg they
// agree within the factor's own error of some percent.
TEST(Klobuchar, ShellAgreesWithBroadcastObliquityOnTheGround) {
  const fsw::Vector3 ground(6371e3, 0.0, 0.0);
  for (const double elevation_deg : {30.0, 50.0, 70.0, 90.0}) {
    const double elevation = elevation_deg * kRadPerDegree;
    const fsw::Vector3 north(std::sin(elevation), 0.0, std::cos(elevation));
    const double shell_m = klobuchar_delay_in_orbit_m(kExample, ground, north, 50400.0);
    const double broadcast_m = klobuchar_delay_m(kExample, 0.0, 0.0, elevation, 0.0, 50400.0);
    EXPECT_NEAR(shell_m / broadcast_m, 1.0, 0.06) << elevation_deg;
  }
}

}  // namespace
}  // namespace vbar::twins::gnss
