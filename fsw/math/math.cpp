#include "fsw/math/math.h"

#include "fsw/math/newlib/vbar_libm.h"

namespace vbar::fsw::math {

double sin(double x) {
  return vbar_libm_sin(x);
}
double cos(double x) {
  return vbar_libm_cos(x);
}
double tan(double x) {
  return vbar_libm_tan(x);
}
double asin(double x) {
  return vbar_libm_asin(x);
}
double acos(double x) {
  return vbar_libm_acos(x);
}
double atan(double x) {
  return vbar_libm_atan(x);
}
double atan2(double y, double x) {
  return vbar_libm_atan2(y, x);
}
double exp(double x) {
  return vbar_libm_exp(x);
}
double log(double x) {
  return vbar_libm_log(x);
}
double pow(double x, double y) {
  return vbar_libm_pow(x, y);
}
double erf(double x) {
  return vbar_libm_erf(x);
}
double erfc(double x) {
  return vbar_libm_erfc(x);
}
double fmod(double x, double y) {
  return vbar_libm_fmod(x, y);
}
double floor(double x) {
  return vbar_libm_floor(x);
}

double wrap_to_pi(double angle) {
  if (-kPi < angle && angle <= kPi) return angle;
  const double remainder = fmod(angle, kTwoPi);  // exact, sign of angle, |remainder| < 2 pi
  if (remainder > kPi) return remainder - kTwoPi;
  if (remainder <= -kPi) return remainder + kTwoPi;
  return remainder;
}

}  // namespace vbar::fsw::math
