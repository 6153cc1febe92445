#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <GeographicLib/SphericalHarmonic.hpp>
#include <erfa.h>
#include <erfam.h>
#include <gtest/gtest.h>

#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/gravity_coefficients.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/sun.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "tests/support/accuracy.h"
#include "tests/support/paths.h"

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
