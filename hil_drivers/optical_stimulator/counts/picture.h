#pragma once
// Picture of a display: a grey count for each pixel.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vbar::optical_stimulator {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> counts;  ///< rows from the top

  Picture() = default;
  Picture(int width_px, int height_px)
      : width(width_px),
        height(height_px),
        counts(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px)) {}

  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  [[nodiscard]] std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::uint8_t& at(int x, int y) { return counts[place(x, y)]; }
  [[nodiscard]] std::uint8_t at(int x, int y) const { return counts[place(x, y)]; }
};

}  // namespace vbar::optical_stimulator
