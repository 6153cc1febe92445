#include "fsw/gnss/ionosphere.h"

#include "fsw/gnss/constants.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnss {
namespace {

// Eight bits with sign, scaled by these (IS-GPS-200N, table 20-X).
constexpr std::array<double, 4> kAlphaUnit{0x1p-30, 0x1p-27, 0x1p-24, 0x1p-24};
constexpr std::array<double, 4> kBetaUnit{0x1p11, 0x1p14, 0x1p16, 0x1p16};
constexpr double kMaxCount = 128.0;

Status within_fields(const std::array<double, 4>& values, const std::array<double, 4>& units) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!math::is_finite(values[k])) return Status::kNotFinite;
    if (math::abs(values[k]) > kMaxCount * units[k]) return Status::kOutOfRange;
  }
  return Status::kOk;
}

double cubic(const std::array<double, 4>& c, double x) {
  return c[0] + (c[1] + (c[2] + c[3] * x) * x) * x;
}

}  // namespace

Status check(const KlobucharCoefficients& coefficients) {
  const Status alpha = within_fields(coefficients.alpha, kAlphaUnit);
  return alpha != Status::kOk ? alpha : within_fields(coefficients.beta, kBetaUnit);
}

Result<double> klobuchar_delay_l1_m(const KlobucharCoefficients& coefficients, const LineOfSight& sight, GpsTime time) {
  const Status status = check(coefficients);
  if (status != Status::kOk) return status;
  if (!math::is_finite(sight.latitude + sight.longitude + sight.azimuth)) return Status::kNotFinite;
  if (!(sight.elevation >= 0.0 && sight.elevation <= math::kPi / 2.0)) return Status::kOutOfRange;

  // Angles in semicircles from here on, as in the document.
  const double elevation = sight.elevation / math::kPi;
  const double earth_angle = 0.0137 / (elevation + 0.11) - 0.022;
  double pierce_latitude = sight.latitude / math::kPi + earth_angle * math::cos(sight.azimuth);
  if (pierce_latitude > 0.416) pierce_latitude = 0.416;
  if (pierce_latitude < -0.416) pierce_latitude = -0.416;
  const double pierce_longitude =
      sight.longitude / math::kPi + earth_angle * math::sin(sight.azimuth) / math::cos(pierce_latitude * math::kPi);
  const double magnetic_latitude = pierce_latitude + 0.064 * math::cos((pierce_longitude - 1.617) * math::kPi);

  constexpr std::int64_t kDayNs = 86'400 * kNanosecondsPerSecond;
  constexpr double kDay = 86'400.0;
  const double local = 4.32e4 * pierce_longitude + seconds({time.ns % kDayNs});
  const double local_time = local - kDay * math::floor(local / kDay);

  const double slant = 1.0 + 16.0 * (0.53 - elevation) * (0.53 - elevation) * (0.53 - elevation);
  constexpr double kNight = 5.0e-9;
  double amplitude = cubic(coefficients.alpha, magnetic_latitude);
  if (amplitude < 0.0) amplitude = 0.0;
  double period = cubic(coefficients.beta, magnetic_latitude);
  if (period < 72'000.0) period = 72'000.0;
  const double x = math::kTwoPi * (local_time - 50'400.0) / period;
  double vertical = kNight;
  if (math::abs(x) < 1.57) vertical += amplitude * (1.0 - x * x / 2.0 + x * x * x * x / 24.0);
  return kSpeedOfLight * slant * vertical;
}

ShellCrossing shell_crossing(const Vector3& position_m, const Vector3& direction) {
  constexpr double kMeanEarthRadius_m = 6371e3;
  constexpr double kPeakAltitude_m = 420e3;
  constexpr double kScaleHeight_m = 100e3;
  const double radius_m = math::sqrt(position_m.squaredNorm());
  const double altitude_m = radius_m - kMeanEarthRadius_m;
  if (!(altitude_m > 0.0)) return {};
  // Electrons below the spacecraft, the integral of the profile; e: all of them.
  const double below = math::exp(1.0 - math::exp(-(altitude_m - kPeakAltitude_m) / kScaleHeight_m));
  const double half = 0.5 * (math::exp(1.0) + below);
  const double shell_m = kMeanEarthRadius_m + kPeakAltitude_m - kScaleHeight_m * math::log(1.0 - math::log(half));
  const double along_m = position_m.dot(direction);
  const double across2_m2 = radius_m * radius_m - along_m * along_m;
  const double left_m2 = shell_m * shell_m - across2_m2;
  if (!(left_m2 > 0.0)) return {};
  const double root_m = math::sqrt(left_m2);
  return {.slant_factor = shell_m / root_m, .distance_m = root_m - along_m};
}

}  // namespace vbar::fsw::gnss
