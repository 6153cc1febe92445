#include "fsw/orbit/earth_rotation.h"

#include <cmath>

#include <erfa.h>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::fsw::orbit {
namespace {

/// ERFA's own chain, IAU 2006/2000A, UT1 and TT from the same GPS time.
Matrix3 erfa_R_itrf_gcrf(GpsTime time, const EarthOrientation& orientation) {
  constexpr double kGpsEpochJd = 2444244.5;
  const double days = std::floor(seconds(time - GpsTime{}) / 86400.0);
  const double fraction =
      static_cast<double>((time.ns - static_cast<std::int64_t>(days) * 86'400'000'000'000)) / 8.64e13;
  const double ut1_minus_gps = orientation.ut1_minus_gps_s + orientation.ut1_rate * seconds(time - orientation.epoch);
  double matrix[3][3];
  const double tt = fraction + 51.184 / 86400.0;
  const double t_centuries = (kGpsEpochJd - 2451545.0 + days + tt) / 36525.0;
  double x = 0.0, y = 0.0, s = 0.0;
  eraXys06a(kGpsEpochJd + days, tt, &x, &y, &s);
  double celestial[3][3];
  eraC2ixys(x, y, s, celestial);
  const double era = eraEra00(kGpsEpochJd + days, fraction + ut1_minus_gps / 86400.0);
  double polar[3][3];
  eraPom00(orientation.pole_x, orientation.pole_y, -47e-6 / 206264.8 * t_centuries, polar);
  eraC2tcio(celestial, era, polar, matrix);
  Matrix3 result;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) result(r, c) = matrix[r][c];
  return result;
}

double angle_between(const Matrix3& a, const Matrix3& b) {
  return (a * b.transpose() - Matrix3::Identity()).norm() / std::sqrt(2.0);
}

GpsTime gps_of_year(double year) {
  return GpsTime{static_cast<std::int64_t>((year - 1980.0137) * 365.25 * 86400.0) * kNanosecondsPerSecond};
}

TEST(OnboardEarthRotation, AgreesWithErfaFrom2000To2040) {
  const EarthOrientation orientation{
      .epoch = gps_of_year(2011.5), .ut1_minus_gps_s = -15.3, .ut1_rate = 1e-8, .pole_x = 1e-6, .pole_y = 2e-6};
  accuracy::Largest largest;
  for (double year = 2000.0; year < 2040.0; year += 0.0137) {
    const GpsTime time = gps_of_year(year);
    largest.add(angle_between(R_itrf_gcrf(time, orientation), erfa_R_itrf_gcrf(time, orientation)));
  }
  // What the header promises; all terms left out together.
  accuracy::expect_below("on-board Earth rotation 2000 to 2040", "ERFA IAU 2006/2000A, 2920 instants", largest, 1e-7,
                         "rad");
}

TEST(OnboardEarthRotation, IsARotation) {
  const Matrix3 r = R_itrf_gcrf(gps_of_year(2011.5), {});
  EXPECT_LT((r * r.transpose() - Matrix3::Identity()).norm(), 1e-14);
}

TEST(OnboardEarthRotation, TurnsEastwardByTheEarthRate) {
  const GpsTime time = gps_of_year(2011.5);
  const Matrix3 change = R_itrf_gcrf(time + duration_of_seconds(10), {}) * R_itrf_gcrf(time, {}).transpose();
  EXPECT_NEAR(change(0, 1), 10.0 * kEarthRotationRate, 1e-10);
}

}  // namespace
}  // namespace vbar::fsw::orbit
