#pragma once
// A camera image in flight software: a region of the detector, 8 or 12 bits per pixel.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw::imaging {

inline constexpr std::size_t kMaxPixels = 400'000;
inline constexpr int kMaxSide = 4096;  ///< largest width and height of an image, px
/// Pixels in every tile but the last (vbar.lcm, image_tile).
inline constexpr int kTilePixels12 = 868;
inline constexpr int kTilePixels8 = 1302;

/// Position of an image on the detector.
struct ImageFrame {
  int width = 0;
  int height = 0;
  int origin_x = 0;  ///< position of its first pixel on the detector
  int origin_y = 0;
  int bits = 12;
  friend constexpr bool operator==(const ImageFrame&, const ImageFrame&) = default;
};

/// A pixel that never arrived. No detector outputs it: 12 bits end at 4095.
inline constexpr std::uint16_t kMissingPixel = 0xFFFF;

/// Pixels of an image: rows from the top, pixels from the left. They are owned by the caller.
struct ImageView {
  ImageFrame frame;
  std::span<const std::uint16_t> pixels;  ///< width * height
};

}  // namespace vbar::fsw::imaging
