#pragma once
// Four single-precision numbers side by side. Every operation rounds according to IEEE 754, one operation at a time:
// bit-identical on every target.
//
// On 32-bit ARM these are NEON's instructions: the compiler uses NEON for floating point only if requested explicitly,
// because NEON flushes denormal numbers to zero (the network has none: architecture.h). VMLA of the Cortex-A9 rounds
// the product and then the sum; VFMA, which rounds once, is never used. Elsewhere they are the compiler's own vectors.

#include <cstdint>

#if defined(__arm__)
#include <arm_neon.h>
#endif

namespace vbar::fsw::pose {

inline constexpr int kLanes = 4;

#if defined(__arm__)

using Lanes = float32x4_t;

inline Lanes load(const float* from) {
  return vld1q_f32(from);
}
inline void store(float* to, Lanes x) {
  vst1q_f32(to, x);
}
inline Lanes all(float x) {
  return vdupq_n_f32(x);
}
inline Lanes sum(Lanes a, Lanes b) {
  return vaddq_f32(a, b);
}
/// Returns sum + w * x[k].
template <int k>
Lanes add_product(Lanes sum, Lanes w, Lanes x) {
  if constexpr (k < 2) {
    return vmlaq_lane_f32(sum, w, vget_low_f32(x), k);
  } else {
    return vmlaq_lane_f32(sum, w, vget_high_f32(x), k - 2);
  }
}
/// Returns x where it exceeds the limit; elsewhere, and for a NaN, 0.
inline Lanes where_above(Lanes x, float limit) {
  return vreinterpretq_f32_u32(vandq_u32(vcgtq_f32(x, all(limit)), vreinterpretq_u32_f32(x)));
}
/// Returns x where its size exceeds the limit; elsewhere, and for a NaN, 0.
inline Lanes where_beyond(Lanes x, float limit) {
  return vreinterpretq_f32_u32(vandq_u32(vcgtq_f32(vabsq_f32(x), all(limit)), vreinterpretq_u32_f32(x)));
}

#else

using Lanes = float __attribute__((vector_size(16)));

inline Lanes load(const float* from) {
  Lanes x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
inline void store(float* to, Lanes x) {
  __builtin_memcpy(to, &x, sizeof x);
}
inline Lanes all(float x) {
  return Lanes{x, x, x, x};
}
inline Lanes sum(Lanes a, Lanes b) {
  return a + b;
}
/// Returns sum + w * x[k].
template <int k>
Lanes add_product(Lanes sum, Lanes w, Lanes x) {
  return sum + w * all(x[k]);
}
/// Returns x where it exceeds the limit; elsewhere, and for a NaN, 0.
inline Lanes where_above(Lanes x, float limit) {
  return x > all(limit) ? x : all(0.0F);
}
/// Returns x where its size exceeds the limit; elsewhere, and for a NaN, 0.
inline Lanes where_beyond(Lanes x, float limit) {
  return ((x > all(limit)) | (x < all(-limit))) ? x : all(0.0F);
}

#endif

}  // namespace vbar::fsw::pose
