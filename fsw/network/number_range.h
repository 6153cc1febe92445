#pragma once
// Why the network gives the same bits everywhere although NEON has no denormal numbers (those below 2^-126, which it
// takes and gives as 0): none arises.
//
// - A weight or bias is 0 or at least kLeastWeight = 2^-40 in size, which load() checks: it is a multiple of 2^-63,
//   because a single-precision number of that size has its last of 24 bits there or higher.
// - What a layer reads is 0 or more than kLeastActivation = 2^-60 in size: a multiple of 2^-83. The rectifiers, the
// sums
//   of a layer with one kept from before, and the taking in of the crop see to that.
// - A product is 0 or more than 2^-100 in size, a normal number; before it is rounded it is a multiple of
//   2^-(63 + 83) = 2^-146, but it has at least the size 2^-100, so rounded to 24 bits a multiple of 2^-123.
// - A sum of multiples of 2^-123 is one, and stays one when rounded: 0 or at least 2^-123 in size, a normal number.
//
// So neither flushing nor gradual underflow ever has anything to do. Too large numbers do no harm either: infinities
// and NaN arise alike on every target (only a NaN's sign and payload differ, and those reach nobody: a rectifier takes
// a NaN for 0, and run() refuses maps that are not finite).

namespace vbar::fsw::network {

inline constexpr float kLeastWeight = 0x1p-40F;
inline constexpr float kGreatestWeight = 0x1p20F;    ///< below this
inline constexpr float kLeastActivation = 0x1p-60F;  ///< above this, or 0
inline constexpr float kGreatestSample = 0x1p20F;    ///< of the crop, in size

}  // namespace vbar::fsw::network
