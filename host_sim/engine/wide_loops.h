#pragma once
// Loops over arrays, compiled for several widths of vector registers; the widest of the computer is selected when the
// program starts.
//
// The bits of a result are the same with each: every element is computed by the same operations in the same order, and
// a*b+c is contracted nowhere (-ffp-contract=off). A loop that sums floating-point numbers is not made vectors at all.

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define VBAR_IS_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VBAR_IS_SANITIZED
#endif

/// Before a function with such loops. What it calls is to be inline. The selection runs before a sanitizer is ready, so
/// that there it is left out.
#if defined(__x86_64__) && !defined(VBAR_IS_SANITIZED)
#define VBAR_WIDE_LOOPS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VBAR_WIDE_LOOPS
#endif

/// Before a function that such functions call.
#define VBAR_INLINE __attribute__((always_inline)) inline
