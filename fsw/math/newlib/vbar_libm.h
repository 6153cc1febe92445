#ifndef VBAR_FSW_MATH_NEWLIB_VBAR_LIBM_H
#define VBAR_FSW_MATH_NEWLIB_VBAR_LIBM_H
/* Newlib's libm under names of its own (rename.h), so that it can stand in one program with the platform's C library.
   No function here sets errno, allocates or keeps state. */

#ifdef __cplusplus
extern "C" {
#endif

double vbar_libm_sin(double x);
double vbar_libm_cos(double x);
double vbar_libm_tan(double x);
double vbar_libm_asin(double x);
double vbar_libm_acos(double x);
double vbar_libm_atan(double x);
double vbar_libm_atan2(double y, double x);
double vbar_libm_exp(double x);
double vbar_libm_log(double x);
double vbar_libm_pow(double x, double y);
double vbar_libm_erf(double x);
double vbar_libm_erfc(double x);
double vbar_libm_fmod(double x, double y);
double vbar_libm_floor(double x);
double vbar_libm_scalbn(double x, int n);

#ifdef __cplusplus
}
#endif

#endif
