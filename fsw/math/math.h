#pragma once
// The mathematics library of flight code: newlib's libm, built from source for every target, under names of its own.
// glibc's results depend on the processor and differ from newlib's in the last bit, so flight code never calls std::sin
// and friends. Square root and fabs are exact by IEEE 754 and come from the compiler.

namespace vbar::fsw::math {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 6.28318530717958647692;
inline constexpr double kDegree = kPi / 180.0;
inline constexpr double kArcsecond = kPi / 648000.0;

double sin(double x);
double cos(double x);
double tan(double x);
double asin(double x);
double acos(double x);
double atan(double x);
double atan2(double y, double x);
double exp(double x);
double log(double x);
double pow(double x, double y);
double erf(double x);
double erfc(double x);
double fmod(double x, double y);
double floor(double x);

inline double sqrt(double x) {
  return __builtin_sqrt(x);
}
inline double abs(double x) {
  return __builtin_fabs(x);
}
inline bool is_finite(double x) {
  return x - x == 0.0;
}

/// Returns sqrt(x^2 + y^2). Overflow is not prevented; it cannot occur with lengths and speeds of orbits.
inline double hypot(double x, double y) {
  return sqrt(x * x + y * y);
}

/// Returns the angle mapped to (-pi, pi].
double wrap_to_pi(double angle);

}  // namespace vbar::fsw::math
