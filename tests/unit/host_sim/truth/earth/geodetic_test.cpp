#include "host_sim/truth/earth/geodetic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <GeographicLib/Geocentric.hpp>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::truth {
namespace {

constexpr double kDegree = M_PI / 180.0;

TEST(Geodetic, AgreesWithGeographicLib) {
  // Karney's conversion is exact (a quartic solved in closed form; here from geodetic to Cartesian, a plain formula).
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  accuracy::Largest angle, height;
  for (int i = 0; i < 20000; ++i) {
    const double latitude_deg = -90.0 + 180.0 * unit(random);
    const double longitude_deg = -180.0 + 360.0 * unit(random);
    const double altitude = 3.6e7 * std::pow(unit(random), 3);
    fsw::Vector3 r;
    GeographicLib::Geocentric::WGS84().Forward(latitude_deg, longitude_deg, altitude, r.x(), r.y(), r.z());
    const GeodeticPosition found = geodetic_from_itrf(r);
    angle.add(std::abs(found.latitude - latitude_deg * kDegree));
    angle.add(std::abs(found.longitude - longitude_deg * kDegree));
    height.add(std::abs(found.altitude - altitude));
  }
  // Rounding: 2e-16 of pi, and of 4e7 m; Bowring's second pass is below it.
  accuracy::expect_below("geodetic latitude and longitude", "GeographicLib Geocentric, 20,000 points to geostationary",
                         angle, 2e-15, "rad");
  accuracy::expect_below("geodetic altitude", "GeographicLib Geocentric, 20,000 points to geostationary", height, 3e-8,
                         "m");
}

TEST(Geodetic, HoldsAtPolesAndEquator) {
  const double polar_radius = 6356752.314245179;  // WGS 84, NIMA TR8350.2
  const GeodeticPosition north = geodetic_from_itrf({0.0, 0.0, polar_radius + 500e3});
  EXPECT_EQ(north.latitude, M_PI / 2.0);
  EXPECT_NEAR(north.altitude, 500e3, 2e-9);  // last place of 7e6
  EXPECT_EQ(geodetic_from_itrf({0.0, 0.0, -polar_radius}).latitude, -M_PI / 2.0);
  const GeodeticPosition west = geodetic_from_itrf({0.0, -6378137.0, 0.0});
  EXPECT_EQ(west.latitude, 0.0);
  EXPECT_EQ(west.longitude, -M_PI / 2.0);
  EXPECT_NEAR(west.altitude, 0.0, 2e-9);
}

TEST(Geodetic, NoNumberGivesNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(geodetic_from_itrf({nan, 0.0, 7e6}).altitude));
}

}  // namespace
}  // namespace vbar::truth
