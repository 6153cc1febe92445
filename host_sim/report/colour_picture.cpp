#include "host_sim/report/colour_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include <png.h>

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

void ColourPicture::line(double x0, double y0, double x1, double y1, const Colour& colour) {
  constexpr double kFarthest = 1e5;
  const double farthest = std::abs(x0) + std::abs(y0) + std::abs(x1) + std::abs(y1);
  if (!(farthest < kFarthest)) return;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::max(std::abs(x1 - x0), std::abs(y1 - y0)))));
  for (int k = 0; k <= steps; ++k) {
    const double part = static_cast<double>(k) / steps;
    set(static_cast<int>(std::lround(x0 + part * (x1 - x0))), static_cast<int>(std::lround(y0 + part * (y1 - y0))),
        colour);
  }
}

void ColourPicture::cross(double x, double y, double half_size, const Colour& colour) {
  line(x - half_size, y, x + half_size, y, colour);
  line(x, y - half_size, x, y + half_size, colour);
}

void ColourPicture::box(double centre_x, double centre_y, double side, const Colour& colour) {
  const double left = centre_x - 0.5 * side, right = centre_x + 0.5 * side;
  const double top = centre_y - 0.5 * side, bottom = centre_y + 0.5 * side;
  line(left, top, right, top, colour);
  line(right, top, right, bottom, colour);
  line(right, bottom, left, bottom, colour);
  line(left, bottom, left, top, colour);
}

/// The image of a circle under the covariance's lower triangular root.
void ColourPicture::ellipse(double x, double y, const std::array<double, 3>& covariance, double sigmas,
                            const Colour& colour) {
  const auto [xx, xy, yy] = covariance;
  if (!(xx > 0.0) || !(xx * yy - xy * xy > 0.0)) return;
  const double a = std::sqrt(xx), b = xy / a, c = std::sqrt(yy - b * b);
  constexpr int kPieces = 36;
  const auto corner = [&](int k) {
    const double angle = 2.0 * M_PI * k / kPieces, u = sigmas * std::cos(angle), v = sigmas * std::sin(angle);
    return std::pair(x + a * u, y + b * u + c * v);
  };
  for (int k = 0; k < kPieces; ++k) {
    const auto [x0, y0] = corner(k);
    const auto [x1, y1] = corner(k + 1);
    line(x0, y0, x1, y1, colour);
  }
}

Colour ColourPicture::at(int x, int y) const {
  const std::size_t first = place(x, y);
  return {rgb_[first], rgb_[first + 1], rgb_[first + 2]};
}

std::vector<std::uint8_t> ColourPicture::png() const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> png(size);
  if (png_image_write_to_memory(&image, png.data(), &size, 0, rgb_.data(), 3 * width_, nullptr) == 0)
    throw std::runtime_error("a picture cannot be made: " + std::string(image.message));
  png.resize(size);
  return png;
}

}  // namespace vbar::report
