#include "fsw/orbit/earth_rotation.h"

#include <array>

#include "fsw/math/math.h"

namespace vbar::fsw::orbit {
namespace {

constexpr double kArcsecond = math::kPi / 648000.0;
constexpr double kDay_s = 86400.0;

// J2000.0 is 2000-01-01 12:00 TT; GPS time began 7300 days and 12 hours before that date's noon of GPS time, and
// TT = GPS + 51.184 s.
constexpr GpsTime kJ2000Gps{7300LL * 86400 * kNanosecondsPerSecond + 43200LL * kNanosecondsPerSecond};
constexpr double kTtMinusGps_s = 51.184;
constexpr double kCentury_s = 36525.0 * kDay_s;

/// A term of nutation: multiples of l, l', F, D and the Moon's node; sine in X and cosine in Y, arcsec.
struct Term {
  std::array<std::int8_t, 5> multiples;
  double x_sin;
  double y_cos;
};

// IERS Conventions 2010, tables 5.2a and b: terms above 1.5 mas. The largest have their printed values; the small ones
// include the effect of neighbouring terms, fitted to the full series over 2000 to 2040.
constexpr std::array<Term, 19> kNutation{{
    {{0, 0, 0, 0, 1}, -6.844318, 9.205236},   {{0, 0, 2, -2, 2}, -0.523908, 0.573033},
    {{0, 0, 2, 0, 2}, -0.090552, 0.097847},   {{0, 0, 0, 0, 2}, 0.082169, -0.089618},
    {{0, 1, 0, 0, 0}, 0.058707, 0.007387},    {{1, 0, 0, 0, 0}, 0.028290, -0.000681},
    {{0, 1, 2, -2, 2}, -0.020587, 0.022437},  {{0, 0, 2, 0, 1}, -0.015407, 0.020061},
    {{1, 0, 2, 0, 2}, -0.011997, 0.012900},   {{0, -1, 2, -2, 2}, 0.008585, -0.009593},
    {{1, 0, 0, -2, 0}, -0.006232, -0.000121}, {{0, 0, 2, -2, 1}, 0.005149, -0.006944},
    {{-1, 0, 2, 0, 2}, 0.004921, -0.005316},  {{0, 0, 0, 2, 0}, 0.002526, -0.000131},
    {{1, 0, 0, 0, 1}, 0.002527, -0.003345},   {{-1, 0, 2, 2, 2}, -0.002371, 0.002548},
    {{-1, 0, 0, 0, 1}, -0.002304, 0.003158},  {{1, 0, 2, 0, 1}, -0.002054, 0.002636},
    {{0, 0, 2, 2, 2}, -0.001532, 0.001641},
}};

// The node's terms that grow with time, arcsec a century.
constexpr double kNodeRateXCos = 0.205833;
constexpr double kNodeRateYSin = 0.153042;

/// Delaunay arguments, rad: l, l', F, D, node (IERS Conventions 2010, eq. 5.43), t in centuries of TT.
std::array<double, 5> delaunay_arguments(double t) {
  const auto arcseconds = [t](double c0, double c1, double c2) {
    constexpr double kRevolution = 1296000.0;
    return math::fmod(c0 + t * (c1 + t * c2), kRevolution) * kArcsecond;
  };
  return {arcseconds(485868.249036, 1717915923.2178, 31.8792), arcseconds(1287104.79305, 129596581.0481, -0.5532),
          arcseconds(335779.526232, 1739527262.8478, -12.7512), arcseconds(1072260.70369, 1602961601.2090, -6.3706),
          arcseconds(450160.398036, -6962890.5431, 7.4722)};
}

struct Pole {
  double x;
  double y;
};

/// Celestial intermediate pole, rad.
Pole celestial_pole(double t) {
  double x = -0.016617 + t * (2004.191898 + t * (-0.4297829 - t * 0.19861834));
  double y = -0.006951 + t * (-0.025896 + t * (-22.4072747 + t * 0.00190059));
  const std::array<double, 5> delaunay = delaunay_arguments(t);
  for (const Term& term : kNutation) {
    double argument = 0.0;
    for (std::size_t k = 0; k < delaunay.size(); ++k) argument += term.multiples[k] * delaunay[k];
    x += term.x_sin * math::sin(argument);
    y += term.y_cos * math::cos(argument);
  }
  x += t * kNodeRateXCos * math::cos(delaunay[4]);
  y += t * kNodeRateYSin * math::sin(delaunay[4]);
  return {x * kArcsecond, y * kArcsecond};
}

Matrix3 rotation_about_z(double angle) {
  const double s = math::sin(angle);
  const double c = math::cos(angle);
  Matrix3 rotation;
  rotation << c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0;
  return rotation;
}

/// Earth rotation angle, rad; the days of UT1 are split to preserve precision.
double earth_rotation_angle(Duration since_j2000_gps, double ut1_minus_gps_s) {
  constexpr std::int64_t kDay_ns = 86400 * kNanosecondsPerSecond;
  const std::int64_t days = since_j2000_gps.ns / kDay_ns;
  const double fraction = (seconds(Duration{since_j2000_gps.ns % kDay_ns}) + ut1_minus_gps_s) / kDay_s;
  constexpr double kExcess = 0.00273781191135448;
  const double revolutions =
      0.7790572732640 + fraction + kExcess * (static_cast<double>(days) + fraction);  // whole days: revolutions
  return math::kTwoPi * (revolutions - math::floor(revolutions));
}

}  // namespace

Matrix3 R_itrf_gcrf(GpsTime time, const EarthOrientation& orientation) {
  const Duration since_j2000 = time - kJ2000Gps;
  const double t = (seconds(since_j2000) + kTtMinusGps_s) / kCentury_s;
  const Pole pole = celestial_pole(t);
  const double a = 0.5 + 0.125 * (pole.x * pole.x + pole.y * pole.y);
  Matrix3 to_pole;
  to_pole << 1.0 - a * pole.x * pole.x, -a * pole.x * pole.y, -pole.x,  //
      -a * pole.x * pole.y, 1.0 - a * pole.y * pole.y, -pole.y,         //
      pole.x, pole.y, 1.0 - a * (pole.x * pole.x + pole.y * pole.y);
  const double cio_locator = -0.5 * pole.x * pole.y;
  const double ut1_minus_gps = orientation.ut1_minus_gps_s + orientation.ut1_rate * seconds(time - orientation.epoch);
  const double era = earth_rotation_angle(since_j2000, ut1_minus_gps);
  Matrix3 polar_motion;  // small angles
  polar_motion << 1.0, 0.0, orientation.pole_x, 0.0, 1.0, -orientation.pole_y, -orientation.pole_x, orientation.pole_y,
      1.0;
  return polar_motion * rotation_about_z(era - cio_locator) * to_pole;
}

}  // namespace vbar::fsw::orbit
