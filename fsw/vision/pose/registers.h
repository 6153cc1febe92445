#pragma once
// Vector registers of a convolution, by the single-precision numbers that one holds.

#include <cstdint>

namespace vbar::fsw::pose {

/// Numbers in a register. Every target has registers of four. The sums have the same bits with each: a lane is one
/// output channel, with the same operations in the same order (convolution.h).
enum class Registers : std::uint8_t { kFour = 4, kEight = 8, kSixteen = 16 };

/// Returns the widest registers of this computer and its operating system. Wider ones than four exist on x86 only
/// (AVX2, AVX-512).
Registers widest_registers();

}  // namespace vbar::fsw::pose
