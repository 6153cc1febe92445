#include <array>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "emulators/optical_stimulator/screen.h"

namespace vbar::optical_stimulator::bench {
namespace {

constexpr std::size_t kHeaderWords = 25;
constexpr std::size_t kColourBytes = 12;
constexpr std::uint32_t kMaxSide = 16384;
enum Word : std::size_t {
  kHeaderSize = 0,
  kVersion = 1,
  kFormat = 2,
  kWidth = 4,
  kHeight = 5,
  kByteOrder = 7,
  kBitsPerPixel = 11,
  kBytesPerLine = 12,
  kRedMask = 14,
  kGreenMask = 15,
  kBlueMask = 16,
  kColours = 19,
};

std::uint32_t word(std::span<const std::uint8_t> file, std::size_t index) {
  const std::uint8_t* at = &file[4 * index];
  return static_cast<std::uint32_t>(at[0]) << 24U | static_cast<std::uint32_t>(at[1]) << 16U |
         static_cast<std::uint32_t>(at[2]) << 8U | at[3];
}

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(fmt::format("the framebuffer of the X server: {}", what));
}

}  // namespace

XwdLayout read_xwd_layout(std::span<const std::uint8_t> file) {
  require(file.size() >= 4 * kHeaderWords, "shorter than the header of an X window dump");
  require(word(file, kVersion) == 7 && word(file, kFormat) == 2, "not an X window dump, version 7, of whole pixels");
  require(word(file, kBitsPerPixel) == 32 && word(file, kByteOrder) == 0, "pixels are not little-endian 32-bit words");
  require(word(file, kRedMask) == 0xff0000U && word(file, kGreenMask) == 0xff00U && word(file, kBlueMask) == 0xffU,
          "red, green and blue are not bytes 2, 1 and 0 of a pixel");
  const std::uint32_t width = word(file, kWidth), height = word(file, kHeight);
  require(width >= 1 && width <= kMaxSide && height >= 1 && height <= kMaxSide, "a size that no display has");
  XwdLayout layout{static_cast<int>(width), static_cast<int>(height), word(file, kBytesPerLine), 0};
  require(layout.bytes_per_line >= std::size_t{4} * width, "lines that are shorter than their pixels");
  require(word(file, kColours) <= 65536, "a table of more than 65536 colours");
  layout.pixels = word(file, kHeaderSize) + kColourBytes * word(file, kColours);
  require(layout.pixels + layout.bytes_per_line * height <= file.size(), "shorter than its pixels");
  return layout;
}

void read_grey(std::span<const std::uint8_t> file, const XwdLayout& layout, std::vector<std::uint8_t>& grey) {
  const auto width = static_cast<std::size_t>(layout.width), height = static_cast<std::size_t>(layout.height);
  grey.resize(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* from = &file[layout.pixels + y * layout.bytes_per_line];
    std::uint8_t* to = &grey[y * width];
    for (std::size_t x = 0; x < width; ++x) {
      const unsigned blue = from[4 * x], green = from[4 * x + 1], red = from[4 * x + 2];
      to[x] = static_cast<std::uint8_t>((54U * red + 183U * green + 19U * blue) >> 8U);
    }
  }
}

}  // namespace vbar::optical_stimulator::bench
