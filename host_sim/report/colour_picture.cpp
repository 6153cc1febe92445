#include "host_sim/report/colour_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <png.h>

#include "host_sim/report/image_png.h"

namespace vbar::report {

ColourPicture::ColourPicture(int width, int height) : width_(width), height_(height) {
  if (width < 1 || height < 1) throw std::invalid_argument("a picture must have pixels");
  rgb_.assign(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
}

std::size_t ColourPicture::place(int x, int y) const {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x));
}

void ColourPicture::set(int x, int y, const Colour& colour) {
  if (holds(x, y)) std::ranges::copy(colour, rgb_.begin() + static_cast<std::ptrdiff_t>(place(x, y)));
}

void ColourPicture::blend(int x, int y, const Colour& colour, double share) {
  if (!holds(x, y) || !(share > 0.0)) return;
  const double part = std::min(share, 1.0);
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint8_t& value = rgb_[place(x, y) + k];
    value = static_cast<std::uint8_t>(std::lround(part * colour[k] + (1.0 - part) * value));
  }
}

std::vector<std::uint8_t> ColourPicture::png() const {
  return encoded_png(width_, height_, PNG_FORMAT_RGB, rgb_.data());
}

}  // namespace vbar::report
