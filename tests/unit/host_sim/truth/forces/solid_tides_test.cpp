#include "host_sim/truth/forces/solid_tides.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <memory>
#include <random>
#include <stdexcept>

#include <erfa.h>
#include <erfam.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/solid_tide_tables.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {

namespace {

using fsw::Vector3;
using Complex = std::complex<double>;

constexpr double kRadius = test::kEarthRadius;

/// The potential of a body's tide by the spherical harmonic addition theorem, each order with its complex Love number:
/// GM_b/r_b (R/r_b)^n (R/r)^(n+1) (2 - delta_0m) (n-m)!/(n+m)! P_nm P_nm Re(k_nm e^(i m (longitude difference))).
/// Legendre functions of the standard library; Love numbers of IERS Conventions 2010, table 6.3.
double tidal_potential(double gm_body, const Vector3& body, const Vector3& r) {
  constexpr double kReal[2][4] = {{0.30190, 0.29830, 0.30102, 0.0}, {0.093, 0.093, 0.093, 0.094}};
  constexpr double kImaginary[2][4] = {{0.0, -0.00144, -0.00130, 0.0}, {0.0, 0.0, 0.0, 0.0}};
  const double longitude = std::atan2(r.y(), r.x()) - std::atan2(body.y(), body.x());
  double sum = 0.0;
  for (unsigned n = 2; n <= 3; ++n) {
    double factorials = 1.0;  // (n-m)!/(n+m)!
    for (unsigned m = 0; m <= n; ++m) {
      if (m > 0) factorials /= (n + m) * (n - m + 1.0);
      const double k = kReal[n - 2][m] * std::cos(m * longitude) - kImaginary[n - 2][m] * std::sin(m * longitude);
      sum += (m == 0 ? 1.0 : 2.0) * factorials * k * std::assoc_legendre(n, m, body.z() / body.norm()) *
             std::assoc_legendre(n, m, r.z() / r.norm()) * std::pow(kRadius / body.norm(), n) *
             std::pow(kRadius / r.norm(), n + 1);
    }
  }
  return gm_body / body.norm() * sum;
}

Vector3 gradient(double gm_body, const Vector3& body, const Vector3& r) {
  constexpr double kStep = 2000.0;  // m
  Vector3 result;
  for (int i = 0; i < 3; ++i) {
    const Vector3 d = kStep * Vector3::Unit(i);
    const auto u = [&](double steps) { return tidal_potential(gm_body, body, r + steps * d); };
    result[i] = (8.0 * (u(1.0) - u(-1.0)) - (u(2.0) - u(-2.0))) / (12.0 * kStep);
  }
  return result;
}

TEST(SolidTides, OneBodysTideIsTheGradientOfItsPotential) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> component;
  const auto direction = [&] { return Vector3(component(random), component(random), component(random)).normalized(); };
  accuracy::Largest largest;
  for (int i = 0; i < 200; ++i) {
    const Vector3 moon = 3.84e8 * direction(), r = 6.85e6 * direction();
    LowDegreeCoefficients change;
    add_love_number_response({kMoonGm / test::kGm, moon}, kRadius, change);
    for (int m = 0; m <= 2; ++m) change.c[4][m] = change.s[4][m] = 0.0;  // the potential above has degrees 2 and 3
    const Vector3 expected = gradient(kMoonGm, moon, r);
    largest.add((acceleration_itrf(change, test::kGm, kRadius, r) - expected).norm() / expected.norm());
  }
  // Central differences of order 4: (step/r)^4 = 7e-15 times the fifth derivative's factor of some hundreds, and
  // rounding of the potential, 1e-16 r/step = 4e-13, over accelerations that may be a tenth of the potential/r.
  accuracy::expect_below("solid tide of one body, degrees 2 and 3",
                         "differences of the potential by the addition theorem, 200 places", largest, 2e-11,
                         "relative");
}

TEST(SolidTides, TheBulgeIsCarriedAheadOfTheMoonByTheEarthsRotation) {
  // Im k22 / (2 Re k22) = -0.0013 / 0.60204: 0.124 deg eastward.
  LowDegreeCoefficients change;
  add_love_number_response({kMoonGm / test::kGm, Vector3(3.84e8, 0.0, 0.0)}, kRadius, change);
  EXPECT_NEAR(0.5 * std::atan2(change.s[2][2], change.c[2][2]) / test::kDegree, 0.124, 5e-4);
}

TEST(SolidTides, Degree4FollowsDegree2) {
  // IERS Conventions 2010, eq. 6.7 beside 6.6: the same factor with k+ for k.
  LowDegreeCoefficients change;
  add_love_number_response({kMoonGm / test::kGm, Vector3(2.9e8, -1.3e8, 2.1e8)}, kRadius, change);
  constexpr double kRatio0 = -0.00089 / 0.30190;
  EXPECT_NEAR(change.c[4][0], kRatio0 * change.c[2][0], 1e-24);  // rounding of 1e-9
  const Complex k21(0.29830, -0.00144), k22(0.30102, -0.00130);
  const Complex c21(change.c[2][1], -change.s[2][1]), c22(change.c[2][2], -change.s[2][2]);
  EXPECT_LT(std::abs(Complex(change.c[4][1], -change.s[4][1]) - c21 / k21 * -0.00080), 1e-24);
  EXPECT_LT(std::abs(Complex(change.c[4][2], -change.s[4][2]) - c22 / k22 * -0.00057), 1e-24);
}

/// Multipliers of tau, s, h, p, N', p_s out of a Doodson number (each but the first is written with 5 added).
struct DoodsonMultipliers {
  int n[6];
};
DoodsonMultipliers doodson_multipliers(int number) {
  DoodsonMultipliers m{};
  for (int i = 5; i >= 0; --i, number /= 10) m.n[i] = number % 10 - (i > 0 ? 5 : 0);
  return m;
}

/// Argument of a tide: the multipliers times the lunar time tau, the mean longitudes of Moon and Sun, of the lunar
/// perigee, minus the lunar node's, and of the solar perigee (Doodson 1921).
double doodson_argument(int number, double gmst, double t) {
  const double l = eraFal03(t), lp = eraFalp03(t), f = eraFaf03(t), d = eraFad03(t), node = eraFaom03(t);
  const double s = f + node, h = s - d, p = s - l, ps = h - lp;
  const double angles[6] = {gmst + M_PI - s, s, h, p, -node, ps};
  const DoodsonMultipliers m = doodson_multipliers(number);
  double argument = 0.0;
  for (int i = 0; i < 6; ++i) argument += m.n[i] * angles[i];
  return argument;
}

TEST(SolidTides, DoodsonNumbersAndDelaunayMultipliersOfTheTablesAreTheSame) {
  const auto check = [](const auto& table, int order) {
    for (const TidalLine& line : table) {
      const DoodsonMultipliers m = doodson_multipliers(line.doodson);
      EXPECT_EQ(m.n[0], order) << line.doodson;
      // With s = F + Omega, h = s - D, p = s - l, p_s = h - l', N' = -Omega.
      const int s = m.n[1] - m.n[0] + m.n[2] + m.n[3] + m.n[5];
      EXPECT_EQ(line.n[0], m.n[3]) << line.doodson;
      EXPECT_EQ(line.n[1], m.n[5]) << line.doodson;
      EXPECT_EQ(line.n[2], -s) << line.doodson;
      EXPECT_EQ(line.n[3], m.n[2] + m.n[5]) << line.doodson;
      EXPECT_EQ(line.n[4], m.n[4] - s) << line.doodson;
    }
  };
  check(kZonalTides, 0);
  check(kDiurnalTides, 1);
  check(kSemidiurnalTides, 2);
}

TEST(SolidTides, FrequencyDependenceIsTheSumOverDoodsonsLines) {
  // Eq. 6.8 as the Conventions print it out for K1: C21 = 470.9e-12 sin(theta) - 30.2e-12 cos(theta),
  // S21 = 470.9e-12 cos(theta) + 30.2e-12 sin(theta); for every line, at random instants of 2000 to 2030.
  FrequencyDependentTides tides;
  std::mt19937_64 random(68);
  std::uniform_real_distribution<double> day(0.0, 11000.0), angle(0.0, 6.28);
  accuracy::Largest largest;
  for (int i = 0; i < 300; ++i) {
    const JulianDate tt{2451545.0, day(random)};
    const double gmst = angle(random), t = tt.fraction / 36525.0;
    LowDegreeCoefficients change;
    tides.add(tt, gmst, change);
    double c20 = 0.0, c21 = 0.0, s21 = 0.0, c22 = 0.0, s22 = 0.0;
    for (const TidalLine& line : kZonalTides) {
      const double theta = doodson_argument(line.doodson, gmst, t);
      c20 += 1e-12 * (line.in_phase * std::cos(theta) - line.out_of_phase * std::sin(theta));
    }
    for (const TidalLine& line : kDiurnalTides) {
      const double theta = doodson_argument(line.doodson, gmst, t);
      c21 += 1e-12 * (line.in_phase * std::sin(theta) + line.out_of_phase * std::cos(theta));
      s21 += 1e-12 * (line.in_phase * std::cos(theta) - line.out_of_phase * std::sin(theta));
    }
    for (const TidalLine& line : kSemidiurnalTides) {
      const double theta = doodson_argument(line.doodson, gmst, t);
      c22 += 1e-12 * line.in_phase * std::cos(theta);
      s22 -= 1e-12 * line.in_phase * std::sin(theta);
    }
    largest.add(std::abs(change.c[2][0] - c20), std::abs(change.c[2][1] - c21), std::abs(change.s[2][1] - s21),
                std::abs(change.c[2][2] - c22), std::abs(change.s[2][2] - s22));
  }
  // The stated error of the interpolation; the tables' last digit is 1e-13.
  accuracy::expect_below("solid tide, frequency-dependent part by interpolation",
                         "IERS Conventions 2010, eq. 6.8 and tables 6.5 line by line, 300 instants", largest, 1e-18,
                         "of a normalised coefficient");
}

/// Lines of the tide in step 1's answer to the real Sun and Moon, Love numbers divided out: A_m H_f in the Conventions'
/// notation. Two periods of the lunar node (18.6 years) in a smooth (Hann) window, which separates neighbours.
struct TidalSpectrum {
  double mean_c20 = 0.0;  ///< not divided
  Complex node, ssa, mf, o1, p1, k1, k1_node, m2;
};

TidalSpectrum tidal_spectrum() {
  constexpr int kSamples = 40000;  // one every 8.2 h; what other lines fall on by that is not near these
  constexpr double kDays = 2.0 * 6798.38, kFirst = 2447892.5;
  TidalSpectrum spectrum;
  CelestialPoleInterpolator pole;
  for (int i = 0; i < kSamples; ++i) {
    const double weight = (1.0 - std::cos(2.0 * M_PI * i / kSamples)) / kSamples;
    const JulianDate tt{kFirst, kDays * i / kSamples};
    // UT1 = TT - 64 s, the mean of these years 1990 to 2027: some seconds off turn a daily tide by some 1e-4 rad.
    const JulianDate ut1{tt.day, tt.fraction - 64.0 / 86400.0};
    const fsw::Matrix3 R = R_itrf_gcrf(pole.at(tt), eraEra00(ut1.day, ut1.fraction), 0.0, 0.0, 0.0);
    const SunMoon bodies = sun_moon_series(tt);
    LowDegreeCoefficients tide;
    add_love_number_response({kMoonGm / test::kGm, R * bodies.moon_eci}, kRadius, tide);
    add_love_number_response({kSunGm / test::kGm, R * bodies.sun_eci}, kRadius, tide);
    const double gmst = eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction);
    const double t = (tt.day - ERFA_DJ00 + tt.fraction) / ERFA_DJC;
    const auto line = [&](int doodson) { return std::polar(weight, -doodson_argument(doodson, gmst, t)); };

    spectrum.mean_c20 += weight * tide.c[2][0];
    const double zonal = 2.0 * tide.c[2][0] / 0.30190;  // a cosine has half its amplitude on either side
    spectrum.node += zonal * line(55565);
    spectrum.ssa += zonal * line(57555);
    spectrum.mf += zonal * line(75555);
    // Eq. 6.8: eta_1 = -i, eta_2 = 1.
    const Complex diurnal = Complex(0.0, 1.0) * Complex(tide.c[2][1], -tide.s[2][1]) / Complex(0.29830, -0.00144);
    spectrum.o1 += diurnal * line(145555);
    spectrum.p1 += diurnal * line(163555);
    spectrum.k1 += diurnal * line(165555);
    spectrum.k1_node += diurnal * line(165565);
    spectrum.m2 += Complex(tide.c[2][2], -tide.s[2][2]) / Complex(0.30102, -0.00130) * line(255555);
  }
  return spectrum;
}

TEST(SolidTides, StepTwosLinesHaveTheSignsAndPhasesOfTheRealSunAndMoon) {
  // Table 6.5 prints the correction (in phase) A_m H_f delta k and delta k, so A_m H_f, the line of the tide itself:
  // real, of either sign. Tolerance: half a unit of the last printed digit of each of the two.
  const TidalSpectrum spectrum = tidal_spectrum();
  const auto expect_line = [](Complex found, double in_phase, double delta_k, double half_digit_k, const char* name) {
    const double expected = 1e-12 * in_phase / delta_k;
    const double tolerance =
        std::abs(expected) * (0.05 / std::abs(in_phase) + half_digit_k / std::abs(delta_k)) + 2e-12;
    EXPECT_NEAR(found.real(), expected, tolerance) << name;
    // Positions of the Sun and Moon to 1e-4 rad, and the constant UT1-TT to seconds, 4e-4 rad of a daily tide.
    EXPECT_NEAR(found.imag(), 0.0, 6e-4 * std::abs(expected) + 2e-12) << name;
  };
  expect_line(spectrum.node, 16.6, 0.01347, 5e-6, "18.6 years");
  expect_line(spectrum.ssa, -5.5, 0.00403, 5e-6, "Ssa");
  expect_line(spectrum.mf, 0.6, -0.00019, 5e-6, "Mf");
  expect_line(spectrum.o1, -6.8, -83e-5, 0.5e-5, "O1");
  expect_line(spectrum.p1, -43.4, -1138e-5, 0.5e-5, "P1");
  expect_line(spectrum.k1, 470.9, -4084e-5, 0.5e-5, "K1");
  expect_line(spectrum.k1_node, 68.1, -4355e-5, 0.5e-5, "K1's neighbour");
  // Table 6.5c's delta k times the amplitude of M2 has neither the sign nor the size of the amplitude printed beside
  // it; the Conventions say to use the latter, 4e-4 of the tide. The line itself: A_2 = 3.1274e-8 / m times H = 0.63192
  // m (Cartwright and Edden 1973), in which today's theories differ by some 1e-4.
  EXPECT_NEAR(spectrum.m2.real(), 3.1274e-8 * 0.63192, 1e-11);
  EXPECT_NEAR(spectrum.m2.imag(), 0.0, 2e-11);  // twice the daily tides' angle
}

TEST(SolidTides, TheMeanOfStepOneIsThePermanentTide) {
  // IERS Conventions 2010, eq. 6.14, from an amplitude H0 printed to 1.6e-5 of itself, at another epoch than the mean
  // of these years: the obliquity's slow change makes 1e-4 a century.
  EXPECT_NEAR(permanent_tide_c20(), -4.4228e-8 * 0.31460 * 0.30190, 1e-22);  // rounding
  accuracy::expect_below(
      "permanent tide, counted once",
      "mean of the tide of the real Sun and Moon over 37.2 years against IERS Conventions 2010, eq. 6.14",
      std::abs(tidal_spectrum().mean_c20 / permanent_tide_c20() - 1.0), 5e-4, "relative");
}

TEST(SolidTides, PoleTideIsTheCentrifugalPotentialsChange) {
  // A pole off by m turns the axis of the centrifugal potential: C21 - i S21 = -k omega^2 R^3 / (sqrt(15) GM) (m1 - i
  // m2) with k = 0.3077 + 0.0036 i (IERS Conventions 2010, section 6.4); the oceans add a sixth of it. On the pole's
  // secular path there is none.
  const JulianDate tt{2451545.0, 11.5 * 365.25};
  constexpr double kArcsec = M_PI / 180.0 / 3600.0;
  const double x = (0.0550 + 0.001677 * 11.5) * kArcsec, y = (0.3205 + 0.003460 * 11.5) * kArcsec;
  LowDegreeCoefficients none, displaced;
  add_pole_tides(x, y, tt, none);
  EXPECT_NEAR(none.c[2][1], 0.0, 1e-22);  // rounding of 1e-9 times half an arcsecond
  EXPECT_NEAR(none.s[2][1], 0.0, 1e-22);
  add_pole_tides(x + 0.2 * kArcsec, y - 0.1 * kArcsec, tt, displaced);
  constexpr double kRotation = 7.292115e-5;
  const Complex m(0.2 * kArcsec, 0.1 * kArcsec);  // m2 = -y
  const Complex solid = -Complex(0.3077, 0.0036) * std::conj(m) * kRotation * kRotation * std::pow(kRadius, 3) /
                        (std::sqrt(15.0) * test::kGm);
  // Ocean pole tide, degree 2, of IERS Conventions 2010, eq. 6.24.
  const double ocean_c = -2.1778e-10 * (0.2 - 0.01724 * 0.1), ocean_s = -1.7232e-10 * (0.1 - 0.03365 * 0.2);
  // The section's factors are printed to 1e-3 of themselves.
  EXPECT_NEAR(displaced.c[2][1], solid.real() + ocean_c, 1e-3 * std::abs(solid));
  EXPECT_NEAR(displaced.s[2][1], -solid.imag() + ocean_s, 1e-3 * std::abs(solid));
}

TEST(SolidTides, CoefficientsOfAnotherProgram) {
  // Orekit (its test of the tides' field): degrees 2 to 4 on 2003-05-06T13:43:32.125 UTC, tide free, without pole tide,
  // Sun and Moon of JPL. Here the Moon is ERFA's (10", 5e-5 rad, up to three times of it in a coefficient), and the
  // pole is at zero (0.3", 1.5e-6 rad); UT1-UTC of the day, -0.35 s, to 0.1 s (7e-6 rad).
  const fsw::GpsTime date = gps_from_utc("2003-05-06T13:43:32.125Z");
  const JulianDate tt = tt_of(date), utc = utc_of(date);
  const fsw::Matrix3 R =
      R_itrf_gcrf(celestial_pole_iau2006a(tt), eraEra00(utc.day, utc.fraction - 0.35 / 86400.0), 0.0, 0.0, 0.0);
  const SunMoon bodies = sun_moon_series(tt);
  LowDegreeCoefficients change;
  add_love_number_response({kMoonGm / test::kGm, R * bodies.moon_eci}, kRadius, change);
  add_love_number_response({kSunGm / test::kGm, R * bodies.sun_eci}, kRadius, change);
  FrequencyDependentTides tides;
  tides.add(tt, eraGmst06(utc.day, utc.fraction - 0.35 / 86400.0, tt.day, tt.fraction), change);
  constexpr double kC[3][4] = {
      {-2.6732289327355114e-9, 4.9078992447259636e-9, 3.5894110538262888e-9, 0.0},
      {-1.290639603871307e-11, -9.287425756410472e-14, 8.356574033404024e-12, -2.2644465207860626e-12},
      {7.888138856951149e-12, -1.4422209452877158e-11, -6.815519349970944e-12, 0.0}};
  constexpr double kS[3][4] = {{0.0, 1.599927449004677e-9, 2.1815888169727694e-9, 0.0},
                               {0.0, -4.6129961143785774e-14, 1.8097527720906976e-11, 1.633889224766215e-11},
                               {0.0, -4.897228975221076e-12, -4.1034042689652575e-12, 0.0}};
  accuracy::Largest largest;
  for (int n = 2; n <= 4; ++n) {
    accuracy::Largest difference, scale;
    for (int m = 0; m <= std::min(n, 3); ++m) {
      difference.add(std::abs(change.c[n][m] - kC[n - 2][m]), std::abs(change.s[n][m] - kS[n - 2][m]));
      scale.add(std::abs(kC[n - 2][m]), std::abs(kS[n - 2][m]));
    }
    largest.add(difference / scale);
  }
  accuracy::expect_below("solid tide, all coefficients of degrees 2 to 4", "Orekit, 2003-05-06T13:43:32.125 UTC",
                         largest, 1.5e-4, "of the degree's largest");
}

TEST(SolidTides, RefusesATideSystemItDoesNotKnow) {
  EXPECT_EQ(tide_system_named("zero_tide"), TideSystem::kZeroTide);
  EXPECT_EQ(tide_system_named("tide_free"), TideSystem::kTideFree);
  EXPECT_THROW(tide_system_named("mean_tide"), std::invalid_argument);
}

}  // namespace

namespace {

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
