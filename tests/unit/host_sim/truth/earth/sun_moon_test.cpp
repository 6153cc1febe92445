#include "host_sim/truth/earth/sun_moon.h"

#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Geometry>
#include <boost/math/tools/minima.hpp>
#include <erfa.h>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;

constexpr double kLightSpeed = 299792458.0;  // m/s
constexpr double kArcsecond = M_PI / 648000.0;

JulianDate later(JulianDate date, double seconds) {
  return {date.day, date.fraction + seconds / kSecondsPerDay};
}

JulianDate tt_of_utc(const char* utc) {
  return tt_of(gps_from_utc(utc));
}

/// As seen: where a body was when its light left it, the Earth's centre held fixed (light time and annual aberration in
/// one, to second order in v/c), on the true equator and equinox of date.
Vector3 apparent(JulianDate tt, Vector3 SunMoon::*body) {
  const double light_time = (sun_moon_series(tt).*body).norm() / kLightSpeed;
  const Vector3 then = sun_moon_series(later(tt, -light_time)).*body;
  double true_equator_gcrs[3][3], out[3];
  eraPnm06a(tt.day, tt.fraction, true_equator_gcrs);
  double in[3] = {then.x(), then.y(), then.z()};
  eraRxp(true_equator_gcrs, in, out);
  return {out[0], out[1], out[2]};
}

TEST(SunMoon, SeriesAreThoseOfErfa) {
  // The expected values of ERFA's own test program for eraEpv00 and eraMoon98, in au.
  const Vector3 sun(0.7757238809297706813, -0.5598052241363340596, -0.2426998466481686993);
  const Vector3 moon(-0.2601295959971044180e-2, 0.6139750944302742189e-3, 0.2640794528229828909e-3);
  // ERFA's program allows 1e-14 and 1e-11 au: the last digits of libm's sines.
  EXPECT_LT((sun_moon_series({2400000.5, 53411.52501161}).sun_eci / kAstronomicalUnit - sun).norm(), 2e-14);
  EXPECT_LT((sun_moon_series({2400000.5, 43999.9}).moon_eci / kAstronomicalUnit - moon).norm(), 2e-11);
}

TEST(SunMoon, InterpolationKeepsToTheSeries) {
  SunMoonInterpolator interpolator;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> five_years(2454832.5, 2456658.5);
  accuracy::Largest sun, moon;
  for (int i = 0; i < 2000; ++i) {
    const double date = five_years(random);
    const JulianDate tt{std::floor(date), date - std::floor(date)};
    const SunMoon exact = sun_moon_series(tt), interpolated = interpolator.at(tt);
    sun.add((interpolated.sun_eci - exact.sun_eci).norm());
    moon.add((interpolated.moon_eci - exact.moon_eci).norm());
  }
  // The header's claims; the series themselves are good to kilometres.
  accuracy::expect_below("Sun's position, interpolated", "ERFA eraEpv00, 2,000 dates 2009 to 2013", sun, 0.1, "m");
  accuracy::expect_below("Moon's position, interpolated", "ERFA eraMoon98, 2,000 dates 2009 to 2013", moon, 1.0, "m");
}

TEST(SunMoon, InterpolationDependsOnTheDateOnly) {
  SunMoonInterpolator forward, backward;
  for (int i = 0; i <= 20; ++i) static_cast<void>(forward.at({2455760.5, 0.1 * i}));
  for (int i = 20; i >= 0; --i) {
    const SunMoon a = backward.at({2455760.5, 0.1 * i}), b = forward.at({2455760.5, 0.1 * i});
    EXPECT_EQ(a.sun_eci, b.sun_eci);
    EXPECT_EQ(a.moon_eci, b.moon_eci);
  }
}

TEST(SunMoon, IsContinuousAtItsNodes) {
  SunMoonInterpolator interpolator;
  const SunMoon before = interpolator.at({2455760.0, 0.25 - 1e-9}), after = interpolator.at({2455760.0, 0.25});
  // 86.4 us apart: 30 km/s and 1 km/s, and the rounding of the fraction of a day (1e-16 of 4 thousand days: 1e-8 s).
  EXPECT_LT((after.sun_eci - before.sun_eci).norm(), 3.0);
  EXPECT_LT((after.moon_eci - before.moon_eci).norm(), 0.11);
}

TEST(SunMoon, AphelionOf2007) {
  // The IMCCE's announcement: 6 July 2007, 23:52 UTC, at 1.01670594387 au. The distance is flat there, so the minute's
  // rounding does not matter; eraEpv00 claims 13.4 km at most, 9e-8 au.
  const auto distance = [](double seconds) {
    return -sun_moon_series(later(tt_of_utc("2007-07-06T23:52:00Z"), seconds)).sun_eci.norm() / kAstronomicalUnit;
  };
  const auto [seconds, negative] = boost::math::tools::brent_find_minima(distance, -40000.0, 40000.0, 40);
  accuracy::expect_below("Sun's distance at the aphelion of 2007", "the IMCCE's ephemeris",
                         1e-3 * kAstronomicalUnit * std::abs(-negative - 1.01670594387), 13.4, "km");
  // 13.4 km of error, of which a wave as short as the month shifts the extremum of so flat a curve by many minutes.
  EXPECT_LT(std::abs(seconds), 1800.0);
}

TEST(SunMoon, SeasonsOf2011) {
  // Equinoxes and solstices of the almanac (US Naval Observatory), UTC to the minute: the Sun's apparent longitude is a
  // multiple of 90 degrees. It moves 1.23 arcsec in half a minute; eraEpv00's 13 km are 0.02 arcsec. Without aberration
  // all would be off by 20 arcsec, or eight minutes.
  int season = 0;
  for (const char* utc :
       {"2011-03-20T23:21:00Z", "2011-06-21T17:16:00Z", "2011-09-23T09:05:00Z", "2011-12-22T05:30:00Z"}) {
    const JulianDate tt = tt_of_utc(utc);
    const Vector3 sun = apparent(tt, &SunMoon::sun_eci);
    double dpsi, deps;
    eraNut06a(tt.day, tt.fraction, &dpsi, &deps);
    const double obliquity = eraObl06(tt.day, tt.fraction) + deps;
    const double longitude = std::atan2(sun.y() * std::cos(obliquity) + sun.z() * std::sin(obliquity), sun.x());
    EXPECT_LT(std::abs(std::remainder(longitude - M_PI_2 * season, 2.0 * M_PI)), 1.3 * kArcsecond) << utc;
    ++season;
  }
}

TEST(SunMoon, AgainstDe405AtAnEclipse) {
  // F. Espenak (NASA), Besselian elements of the total solar eclipse of 2012-11-13: apparent places at 22:12:55.2 TT by
  // JPL DE405, right ascension to 0.1 s (1.5 arcsec), declination to 0.1 arcsec, the Moon's parallax to 0.1 arcsec.
  const JulianDate tt{2456245.0, 0.5 - 0.5 + (10.0 * 3600.0 + 12.0 * 60.0 + 55.2) / kSecondsPerDay};
  const auto printed = [](double hours, double minutes, double seconds, double degrees, double arcmin, double arcsec) {
    const double ra = (hours * 3600.0 + minutes * 60.0 + seconds) * 15.0 * kArcsecond;
    const double dec = -(degrees * 3600.0 + arcmin * 60.0 + arcsec) * kArcsecond;
    return Vector3(std::cos(dec) * std::cos(ra), std::cos(dec) * std::sin(ra), std::sin(dec));
  };
  const auto angle = [](const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); };
  const Vector3 sun = apparent(tt, &SunMoon::sun_eci), moon = apparent(tt, &SunMoon::moon_eci);
  // Sun: the printed right ascension's half unit. Moon: that and ERFA's worst direction, 18.3 arcsec.
  accuracy::expect_below("Sun's direction", "JPL DE405 at the eclipse of 2012-11-13, printed to 0.75 arcsec",
                         angle(sun, printed(15, 18, 6.7, 18, 15, 2.6)) / kArcsecond, 0.8, "arcsec");
  accuracy::expect_below("Moon's direction", "JPL DE405 at the eclipse of 2012-11-13, printed to 0.75 arcsec",
                         angle(moon, printed(15, 17, 51.2, 18, 37, 29.5)) / kArcsecond, 19.1, "arcsec");
  // 6378.137 km over the sine of 1 deg 1' 19.0", whose half unit is 5 km; and ERFA's worst distance, 32 km.
  const double parallax = (3600.0 + 60.0 + 19.0) * kArcsecond;
  accuracy::expect_below("Moon's distance", "JPL DE405 at the eclipse of 2012-11-13, printed to 5 km",
                         1e-3 * std::abs(moon.norm() - 6378137.0 / std::sin(parallax)), 37.0, "km");
}

TEST(SunMoon, TheMoonsShadowPassesTheEarthsCentreWhereItDid) {
  // The same elements: gamma, the least distance of the shadow's axis from the Earth's centre in equatorial radii, is
  // -0.3719 (negative: south), at 22:12:55.2 TT. A kilometre of the Moon is 1.6e-4: ERFA's 32 km at worst are 0.005;
  // the axis moves 0.6 km/s, so that they are 53 s as well.
  const JulianDate noon{2456245.0, 0.0};
  const auto axis = [&](double seconds) {
    const JulianDate tt = later(noon, seconds);
    const Vector3 sun = apparent(tt, &SunMoon::sun_eci), moon = apparent(tt, &SunMoon::moon_eci);
    const Vector3 direction = (moon - sun).normalized();
    return Vector3(moon - moon.dot(direction) * direction);
  };
  const double expected = 10.0 * 3600.0 + 12.0 * 60.0 + 55.2;
  const auto [seconds, squared] = boost::math::tools::brent_find_minima([&](double t) { return axis(t).squaredNorm(); },
                                                                        expected - 3600.0, expected + 3600.0, 30);
  EXPECT_NEAR(seconds, expected, 53.0);
  EXPECT_NEAR(std::sqrt(squared) / 6378137.0, 0.3719, 0.005);
  EXPECT_LT(axis(seconds).z(), 0.0);
}

}  // namespace
}  // namespace vbar::truth
