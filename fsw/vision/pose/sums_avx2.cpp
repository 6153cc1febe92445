// Compiled for AVX2: 16 registers of eight numbers.

#include "fsw/vision/pose/wide_sums.h"

namespace vbar::fsw::pose {

void sum_strip_avx2(const Strip& strip) {
  int channel = sum_channels<8, 2, 4>(strip, 0);
  channel = sum_channels<8, 1, 8>(strip, channel);
  sum_channels<4, 1, 8>(strip, channel);
}

}  // namespace vbar::fsw::pose
