// Compiled for AVX-512: 32 registers of sixteen numbers.

#include "fsw/vision/pose/wide_sums.h"

namespace vbar::fsw::pose {

void sum_strip_avx512(const Strip& strip) {
  int channel = sum_channels<16, 2, 8>(strip, 0);
  channel = sum_channels<16, 1, 8>(strip, channel);
  channel = sum_channels<8, 1, 8>(strip, channel);
  sum_channels<4, 1, 8>(strip, channel);
}

}  // namespace vbar::fsw::pose
