#include "hil_drivers/gige/camera/pixel_padding.h"

#include <algorithm>
#include <bit>

namespace vbar::gige {

PixelPadding::PixelPadding(int expected_bits) : expected_bits_(expected_bits) {}

void PixelPadding::observe(std::span<const std::uint16_t> pixels) {
  std::uint16_t set_bits = set_bits_;
  for (const std::uint16_t pixel : pixels) set_bits |= pixel;
  set_bits_ = set_bits;
  for (std::size_t k = 0; k < pixels.size() && !is_decided(); ++k) {
    if (seen_.test(pixels[k])) continue;
    seen_.set(pixels[k]);
    ++values_;
  }
}

int PixelPadding::shift() const {
  const int expected = 16 - expected_bits_;
  const int zeros = std::countr_zero(set_bits_);  // 16 if no bit was ever set
  // Bits below the expected padding are real, whatever the number of values.
  if (zeros < expected) {
    // Numbers of the expected converter that are right-aligned.
    if (set_bits_ < (1U << expected_bits_)) return 0;
    return zeros / 2 * 2;
  }
  if (!is_decided()) return expected;
  // Converters have an even number of bits, 8 or more.
  return std::min(zeros, 8) / 2 * 2;
}

int PixelPadding::bits() const {
  const int found = shift();
  if (found == 0 && set_bits_ < (1U << expected_bits_)) return expected_bits_;
  return 16 - found;
}

}  // namespace vbar::gige
