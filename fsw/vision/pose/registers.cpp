#include "fsw/vision/pose/registers.h"

namespace vbar::fsw::pose {

Registers widest_registers() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return Registers::kSixteen;
  if (__builtin_cpu_supports("avx2")) return Registers::kEight;
#endif
  return Registers::kFour;
}

}  // namespace vbar::fsw::pose
