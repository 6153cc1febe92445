#include "fsw/orbit/sun.h"

#include "fsw/math/math.h"

namespace vbar::fsw::orbit {
namespace {

constexpr double kObliquity = 23.43929111 * math::kDegree;  // obliquity of the ecliptic at J2000
constexpr double kSpeedOfLight = 299'792'458.0;

// J2000.0 is 7300 days and 12 hours after the beginning of GPS time; TT = GPS + 51.184 s.
constexpr GpsTime kJ2000Gps{(7300LL * 86400 + 43200) * kNanosecondsPerSecond};
constexpr double kTtMinusGps_s = 51.184;
constexpr double kCentury_s = 36525.0 * 86400.0;

double centuries_tt(GpsTime time) {
  return (seconds(time - kJ2000Gps) + kTtMinusGps_s) / kCentury_s;
}

double radians(double degrees) {
  return math::fmod(degrees, 360.0) * math::kDegree;
}

// Mean elements of the barycentre of Earth and Moon (Standish 1992), degrees, ecliptic and equinox of J2000; and mean
// longitudes of the Moon and of Jupiter.
double mean_longitude(double t) {
  return radians(100.46457166 + 35999.37244981 * t);
}
double perihelion(double t) {
  return radians(102.93768193 + 0.32327364 * t);
}
double eccentricity(double t) {
  return 0.01671123 - 0.00004392 * t;
}
double moon_longitude(double t) {
  return radians(218.3164 + 481266.4841 * t);
}
double jupiter_longitude(double t) {
  return radians(34.3964 + 3034.7461 * t);
}

constexpr double kSemiMajorAxis = 149'598'261e3;
constexpr double kCircularSpeed = 29'784.7;       // speed of the barycentre of Earth and Moon
constexpr double kEarthFromBarycentre = 4.671e6;  // mean
constexpr double kEarthSpeedByMoon = 12.43;
constexpr double kSunSpeedByJupiter = 12.47;

/// Perturbations of the longitude by Venus (two terms) and Jupiter (Meeus 1982, chapter 18; its time is from 1900).
double perturbations(double t) {
  const double t1900 = t + 1.0;
  return math::kDegree * (0.00134 * math::cos(radians(153.23 + 22518.7541 * t1900)) +
                          0.00154 * math::cos(radians(216.57 + 45037.5082 * t1900)) +
                          0.00200 * math::cos(radians(312.69 + 32964.3577 * t1900)));
}

/// True longitude: mean longitude, the equation of the centre to the third power of the eccentricity, perturbations.
double true_longitude(double t) {
  const double e = eccentricity(t);
  const double m = mean_longitude(t) - perihelion(t);
  return mean_longitude(t) + (2.0 * e - 0.25 * e * e * e) * math::sin(m) + 1.25 * e * e * math::sin(2.0 * m) +
         13.0 / 12.0 * e * e * e * math::sin(3.0 * m) + perturbations(t);
}

/// Returns the equatorial vector of one in ecliptic axes, z towards the ecliptic's pole.
Vector3 equatorial(double x, double y, double z) {
  const double c = math::cos(kObliquity);
  const double s = math::sin(kObliquity);
  return {x, c * y - s * z, s * y + c * z};
}

}  // namespace

Vector3 sun_position_gcrf(GpsTime time) {
  const double t = centuries_tt(time);
  const double e = eccentricity(t);
  const double longitude = true_longitude(t);
  const double distance = kSemiMajorAxis * (1.0 - e * e) / (1.0 + e * math::cos(longitude - perihelion(t)));
  const double moon = moon_longitude(t);
  // The ecliptic of date is tilted by 47 arcsec a century.
  const double tilt = radians(0.0130548 * t);
  constexpr double kAxisOfTilt = 174.8764 * math::kDegree;
  return equatorial(kEarthFromBarycentre * math::cos(moon) - distance * math::cos(longitude),
                    kEarthFromBarycentre * math::sin(moon) - distance * math::sin(longitude),
                    -distance * tilt * math::sin(longitude - kAxisOfTilt));
}

Vector3 earth_velocity_over_c_gcrf(GpsTime time) {
  const double t = centuries_tt(time);
  const double e = eccentricity(t);
  const double speed = kCircularSpeed / math::sqrt(1.0 - e * e);
  const double longitude = true_longitude(t);
  const double moon = moon_longitude(t);
  const double jupiter = jupiter_longitude(t);
  // Along the ellipse; corrected for the Moon, along its own path; and for the motion of the Sun due to Jupiter.
  const double x = -speed * (math::sin(longitude) + e * math::sin(perihelion(t))) +
                   kEarthSpeedByMoon * math::sin(moon) + kSunSpeedByJupiter * math::sin(jupiter);
  const double y = speed * (math::cos(longitude) + e * math::cos(perihelion(t))) - kEarthSpeedByMoon * math::cos(moon) -
                   kSunSpeedByJupiter * math::cos(jupiter);
  return equatorial(x, y, 0.0) / kSpeedOfLight;
}

}  // namespace vbar::fsw::orbit
