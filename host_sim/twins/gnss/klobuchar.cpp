#include "host_sim/twins/gnss/klobuchar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fsw/gnss/constants.h"

namespace vbar::twins::gnss {
namespace {

constexpr double kPi = std::numbers::pi;
// Parameters of the share above an altitude: peak of the electrons and scale height (Montenbruck, Gill 2002).
constexpr double kPeakAltitude_m = 420e3;
constexpr double kScaleHeight_m = 100e3;
constexpr double kMeanEarthRadius_m = 6371e3;

// The integrated profile: rises from 0 deep below the peak to e far above it.
double integrated_profile(double altitude_m) {
  return std::exp(1.0 - std::exp(-(altitude_m - kPeakAltitude_m) / kScaleHeight_m));
}

double polynomial(const std::array<double, 4>& c, double x) {
  return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

// Where the series of the cosine is taken as zero. The specification's value leaves a step of 2 % of the amplitude,
// through which two receivers some hundred metres apart pass a tenth of a second after each other: a contradiction of
// their carrier phases. Above the ground, where the model is this project's own, the series ends at its zero.
constexpr double kSpecifiedHalfWidth = 1.57;
const double kContinuousHalfWidth = std::sqrt(6.0 - std::sqrt(12.0));

// Delay at the ionospheric point (semicircles) for obliquity factor F, m.
double delay_at_point_m(const KlobucharCoefficients& coefficients, double latitude_sc, double longitude_sc,
                        double obliquity, double seconds_of_week, double half_width) {
  const double geomagnetic_sc = latitude_sc + 0.064 * std::cos((longitude_sc - 1.617) * kPi);
  double local_time_s = std::fmod(4.32e4 * longitude_sc + seconds_of_week, 86400.0);
  if (local_time_s < 0.0) local_time_s += 86400.0;
  const double amplitude_s = std::max(0.0, polynomial(coefficients.alpha, geomagnetic_sc));
  const double period_s = std::max(72000.0, polynomial(coefficients.beta, geomagnetic_sc));
  const double x = 2.0 * kPi * (local_time_s - 50400.0) / period_s;
  double delay_s = 5e-9;
  if (std::abs(x) < half_width) delay_s += amplitude_s * (1.0 - x * x / 2.0 + x * x * x * x / 24.0);
  return fsw::gnss::kSpeedOfLight * obliquity * delay_s;
}

}  // namespace

double klobuchar_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude, double elevation,
                         double azimuth, double seconds_of_week) {
  const double elevation_sc = elevation / kPi;
  const double earth_angle_sc = 0.0137 / (elevation_sc + 0.11) - 0.022;
  const double latitude_sc = std::clamp(latitude / kPi + earth_angle_sc * std::cos(azimuth), -0.416, 0.416);
  const double longitude_sc = longitude / kPi + earth_angle_sc * std::sin(azimuth) / std::cos(latitude_sc * kPi);
  const double below = 0.53 - elevation_sc;
  return delay_at_point_m(coefficients, latitude_sc, longitude_sc, 1.0 + 16.0 * below * below * below, seconds_of_week,
                          kSpecifiedHalfWidth);
}

double klobuchar_vertical_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude,
                                  double seconds_of_week) {
  return delay_at_point_m(coefficients, std::clamp(latitude / kPi, -0.416, 0.416), longitude / kPi, 1.0,
                          seconds_of_week, kContinuousHalfWidth);
}

double electron_content_above(double altitude_m) {
  const double ground = integrated_profile(0.0);
  return (std::numbers::e - integrated_profile(std::max(altitude_m, 0.0))) / (std::numbers::e - ground);
}

double shell_altitude_m(double altitude_m) {
  const double half = (std::numbers::e + integrated_profile(std::max(altitude_m, 0.0))) / 2.0;
  return kPeakAltitude_m - kScaleHeight_m * std::log(1.0 - std::log(half));
}

double klobuchar_delay_in_orbit_m(const KlobucharCoefficients& coefficients, const fsw::Vector3& position_ecef,
                                  const fsw::Vector3& line_of_sight, double seconds_of_week) {
  const double radius_m = position_ecef.norm();
  const double altitude_m = radius_m - kMeanEarthRadius_m;
  const double shell_m = kMeanEarthRadius_m + shell_altitude_m(altitude_m);
  const double along_m = position_ecef.dot(line_of_sight);  // r sin(elevation)
  const double cos_elevation_squared = 1.0 - along_m * along_m / (radius_m * radius_m);
  const double sine = radius_m * radius_m * cos_elevation_squared / (shell_m * shell_m);
  const double slant = 1.0 / std::sqrt(1.0 - sine);
  const double to_shell_m = -along_m + std::sqrt(along_m * along_m + shell_m * shell_m - radius_m * radius_m);
  const fsw::Vector3 pierce = position_ecef + to_shell_m * line_of_sight;
  // Spherical latitude is enough for a model of half the true delay.
  const double latitude = std::asin(pierce.z() / pierce.norm());
  const double longitude = std::atan2(pierce.y(), pierce.x());
  return klobuchar_vertical_delay_m(coefficients, latitude, longitude, seconds_of_week) *
         electron_content_above(altitude_m) * slant;
}

}  // namespace vbar::twins::gnss
