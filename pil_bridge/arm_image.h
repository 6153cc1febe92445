#pragma once
// Whether a file is a program for the emulated ARM processor, by its ELF header: the emulators only fail to start, or
// execute what they are given.

#include <string>

namespace vbar::pil {

/// Returns what `file` is instead of an ELF program for 32-bit ARM, little-endian, and what is accepted; empty if it is
/// one.
/// `is_for_linux`: also one that is relocated when it is loaded.
[[nodiscard]] std::string fault_of_arm_image(const std::string& file, bool is_for_linux);

}  // namespace vbar::pil
