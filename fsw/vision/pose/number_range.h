#pragma once
// Bounds of the numbers in the network. It is bit-identical everywhere although NEON has no denormal numbers (those
// below 2^-126, which it reads and writes as 0), because none arises.
//
// - A weight or bias is 0 or at least kMinWeight = 2^-40 in size, which load() checks: it is a multiple of 2^-63,
//   because a single-precision number of that size has its last of 24 bits there or higher.
// - An input of a layer is 0 or more than kMinActivation = 2^-60 in size: a multiple of 2^-83. This is ensured by
//   the ReLU, the sum of a layer with its skip connection, and the standardisation of the crop.
// - A product is 0 or more than 2^-100 in size, a normal number; before it is rounded it is a multiple of
//   2^-(63 + 83) = 2^-146, but it has at least the size 2^-100, so rounded to 24 bits a multiple of 2^-123.
// - A sum of multiples of 2^-123 is one, and stays one when rounded: 0 or at least 2^-123 in size, a normal number.
//
// So neither flushing nor gradual underflow ever occurs. Large numbers are harmless as well: infinities and NaN arise
// alike on every target (only a NaN's sign and payload differ, and these are not visible: a ReLU maps a NaN to 0, and
// run() rejects heatmaps that are not finite).

namespace vbar::fsw::pose {

inline constexpr float kMinWeight = 0x1p-40F;
inline constexpr float kGreatestWeight = 0x1p20F;  ///< every weight is below
inline constexpr float kMinActivation = 0x1p-60F;  ///< every activation is above, or 0
inline constexpr float kGreatestSample = 0x1p20F;  ///< largest size of a sample of the crop

}  // namespace vbar::fsw::pose
