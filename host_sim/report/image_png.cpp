#include "host_sim/report/image_png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <png.h>

namespace vbar::report {
namespace {

// Colours of the picture's palette: shades of grey, then those of the marks.
constexpr int kShades = 252;
constexpr std::uint8_t kMissing = 252;
constexpr std::uint8_t kRed = 253, kGreen = 254, kBlue = 255;
constexpr std::uint16_t kMissingPixel = 0xFFFF;

using Palette = std::array<std::uint8_t, 3 * 256>;

Palette make_palette() {
  Palette palette{};
  const auto set = [&](std::size_t index, std::array<std::uint8_t, 3> rgb) {
    std::copy(rgb.begin(), rgb.end(), palette.begin() + static_cast<std::ptrdiff_t>(3 * index));
  };
  for (std::size_t shade = 0; shade < kShades; ++shade) {
    const auto grey = static_cast<std::uint8_t>((255 * shade + (kShades - 1) / 2) / (kShades - 1));
    set(shade, {grey, grey, grey});
  }
  set(kMissing, {60, 30, 70});
  set(kRed, {230, 40, 40});
  set(kGreen, {40, 210, 60});
  set(kBlue, {70, 120, 255});
  return palette;
}

std::uint8_t shade_of(std::uint16_t dn, const Stretch& stretch) {
  if (dn == kMissingPixel) return kMissing;
  const double span = std::max(stretch.white_dn - stretch.black_dn, 1.0);
  const double place = std::clamp((dn - stretch.black_dn) / span, 0.0, 1.0);
  const double bright = std::asinh(stretch.softness * place) / std::asinh(stretch.softness);
  return static_cast<std::uint8_t>(std::lround(bright * (kShades - 1)));
}

/// The picture in palette indices.
struct Canvas {
  int width, height;
  std::vector<std::uint8_t> index;

  void set(long x, long y, std::uint8_t colour) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    index[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = colour;
  }
};

struct Point {
  double x, y;
};

void draw_line(Canvas& canvas, Point from, Point to, std::uint8_t colour) {
  const double length = std::max(std::abs(to.x - from.x), std::abs(to.y - from.y));
  const long steps = std::max(1L, std::lround(std::min(length, 1e5)));
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(steps);
    canvas.set(std::lround(from.x + t * (to.x - from.x)), std::lround(from.y + t * (to.y - from.y)), colour);
  }
}

/// A regular polygon about a circle, its first corner at `first_rad` from the right, turning down.
void draw_polygon(Canvas& canvas, Point centre, double radius, int corners, double first_rad, std::uint8_t colour) {
  const double step = 2.0 * 3.14159265358979323846 / corners;
  const double corner_radius = radius / std::cos(0.5 * step);
  const auto corner = [&](int k) {
    const double angle = first_rad + k * step;
    return Point{centre.x + corner_radius * std::cos(angle), centre.y + corner_radius * std::sin(angle)};
  };
  for (int k = 0; k < corners; ++k) draw_line(canvas, corner(k), corner(k + 1), colour);
}

void draw_mark(Canvas& canvas, const ImageMark& mark, const CameraPicture& picture, int enlargement) {
  constexpr double kEighth = 0.25 * 3.14159265358979323846;
  const double scale = enlargement;
  // The centre of an enlarged pixel lies half of what it grew by further on.
  const Point centre{scale * (mark.x_px - picture.origin_x) + 0.5 * (scale - 1.0),
                     scale * (mark.y_px - picture.origin_y) + 0.5 * (scale - 1.0)};
  const double radius = scale * mark.radius_px;
  const double farthest = std::abs(centre.x) + std::abs(centre.y) + std::abs(radius);
  if (!(farthest < 1e6)) return;  // far outside, or not a number
  switch (mark.shape) {
    case MarkShape::kBox:
      return draw_polygon(canvas, centre, radius, 4, kEighth, kRed);
    case MarkShape::kCircle:
      return draw_polygon(canvas, centre, radius, 48, 0.0, kGreen);
    case MarkShape::kTriangle:
      return draw_polygon(canvas, centre, radius, 3, -2.0 * kEighth, kBlue);
  }
}

Canvas make_canvas(const CameraPicture& picture, const Stretch& stretch, int enlargement) {
  Canvas canvas{picture.width * enlargement, picture.height * enlargement, {}};
  canvas.index.reserve(static_cast<std::size_t>(canvas.width) * static_cast<std::size_t>(canvas.height));
  for (int y = 0; y < canvas.height; ++y) {
    const auto row = static_cast<std::size_t>(y / enlargement) * static_cast<std::size_t>(picture.width);
    for (int x = 0; x < canvas.width; ++x)
      canvas.index.push_back(shade_of(picture.dn[row + static_cast<std::size_t>(x / enlargement)], stretch));
  }
  return canvas;
}

std::vector<std::uint8_t> encode(const Canvas& canvas) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(canvas.width);
  image.height = static_cast<png_uint_32>(canvas.height);
  image.format = PNG_FORMAT_RGB_COLORMAP;
  image.colormap_entries = 256;
  const Palette palette = make_palette();
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> png(size);
  const bool good =
      png_image_write_to_memory(&image, png.data(), &size, 0, canvas.index.data(), canvas.width, palette.data()) != 0;
  if (!good) throw std::runtime_error("a picture cannot be made: " + std::string(image.message));
  png.resize(size);
  return png;
}

}  // namespace

Stretch stretch_for(const CameraPicture& picture) {
  std::vector<std::uint16_t> sorted;
  for (const std::uint16_t dn : picture.dn)
    if (dn != kMissingPixel) sorted.push_back(dn);
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  const double sigma = std::max(median - static_cast<double>(sorted[sorted.size() * 16 / 100]), 1.0);
  Stretch stretch;
  stretch.black_dn = median + 2.0 * sigma;
  stretch.softness = 1000.0;  // a star a hundredth as bright as the brightest shows as a third of white
  stretch.white_dn = std::max(static_cast<double>(sorted.back()), stretch.black_dn + 20.0 * sigma);
  return stretch;
}

std::vector<std::uint8_t> png_of(const CameraPicture& picture, const Stretch& stretch, std::span<const ImageMark> marks,
                                 int enlargement) {
  const bool has_pixels =
      picture.width > 0 && picture.height > 0 && enlargement > 0 &&
      picture.dn.size() == static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (!has_pixels) throw std::invalid_argument("a picture must have the pixels that its size says");
  Canvas canvas = make_canvas(picture, stretch, enlargement);
  for (const ImageMark& mark : marks) draw_mark(canvas, mark, picture, enlargement);
  return encode(canvas);
}

std::string png_data_uri(std::span<const std::uint8_t> png) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string uri = "data:image/png;base64,";
  for (std::size_t k = 0; k < png.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, png.size() - k);
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8U | (j < count ? png[k + j] : 0U);
    for (std::size_t j = 0; j < 4; ++j) uri += j <= count ? kDigits[group >> (18 - 6 * j) & 63U] : '=';
  }
  return uri;
}

}  // namespace vbar::report
