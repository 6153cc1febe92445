#ifndef VBAR_FSW_MATH_NEWLIB_RENAME_H
#define VBAR_FSW_MATH_NEWLIB_RENAME_H
/* Force-included before every newlib source: gives each external name of the library the prefix vbar_libm_.

   The IEEE cores (__ieee754_asin, ...) get the public names directly, so newlib's errno wrappers are not needed. What
   IEEE 754 defines exactly (square root, absolute value, sign copy) is left to the compiler: one instruction on every
   target. */

/* The platform's own declarations have to be seen before their names become macros. */
#include <math.h>
#include <sys/types.h>

#include "vbar_libm.h"

/* public */
#define sin vbar_libm_sin
#define cos vbar_libm_cos
#define tan vbar_libm_tan
#define atan vbar_libm_atan
#define exp vbar_libm_exp
#define log vbar_libm_log
#define pow vbar_libm_pow
#define erf vbar_libm_erf
#define erfc vbar_libm_erfc
#define floor vbar_libm_floor
#define scalbn vbar_libm_scalbn
#define __ieee754_asin vbar_libm_asin
#define __ieee754_acos vbar_libm_acos
#define __ieee754_atan2 vbar_libm_atan2
#define __ieee754_fmod vbar_libm_fmod

/* internal */
#define __ieee754_rem_pio2 vbar_libm_ieee754_rem_pio2
#define __kernel_rem_pio2 vbar_libm_kernel_rem_pio2
#define __kernel_sin vbar_libm_kernel_sin
#define __kernel_cos vbar_libm_kernel_cos
#define __kernel_tan vbar_libm_kernel_tan
#define __exp_data vbar_libm_exp_data
#define __log_data vbar_libm_log_data
#define __pow_log_data vbar_libm_pow_log_data
#define __math_oflow vbar_libm_math_oflow
#define __math_uflow vbar_libm_math_uflow
#define __math_divzero vbar_libm_math_divzero
#define __math_invalid vbar_libm_math_invalid
#define __math_check_oflow vbar_libm_math_check_oflow
#define __math_check_uflow vbar_libm_math_check_uflow

/* exact operations; function-like, so that fdlibm.h's declarations of these names stay what they are */
#undef fabs
#undef copysign
#define fabs(x) __builtin_fabs(x)
#define copysign(x, y) __builtin_copysign(x, y)
#define __ieee754_sqrt(x) __builtin_sqrt(x)

#endif
