#pragma once
// Framebuffer file of Xvfb: an X window dump (XWD, version 7) whose pixels the server changes in place.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vbar::optical_stimulator::bench {

struct XwdLayout {
  int width = 0, height = 0;
  std::size_t bytes_per_line = 0;
  std::size_t pixels = 0;  ///< offset of the first
};

/// Reads the header (big-endian words). Throws std::runtime_error, one sentence, for a file that is not a dump of
/// 32-bit pixels with red, green and blue in bytes 2, 1 and 0 of a little-endian word, or that is too short for its
/// pixels.
[[nodiscard]] XwdLayout read_xwd_layout(std::span<const std::uint8_t> file);

/// Reads the grey values of the pixels, rows from the top: luma by ITU-R BT.709 in 256ths, the value itself of a grey
/// pixel.
void read_grey(std::span<const std::uint8_t> file, const XwdLayout& layout, std::vector<std::uint8_t>& grey);

}  // namespace vbar::optical_stimulator::bench
