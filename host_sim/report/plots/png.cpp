#include "host_sim/report/plots/png.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <openssl/evp.h>
#include <png.h>

namespace vbar::report {

namespace {

// The picture's palette: shades of grey, then the colour of missing pixels.
constexpr int kShades = 255;
constexpr std::uint8_t kMissing = 255;
constexpr std::uint16_t kMissingPixel = 0xFFFF;

using Palette = std::array<std::uint8_t, 3 * 256>;

Palette make_palette() {
  Palette palette{};
  for (std::size_t shade = 0; shade < kShades; ++shade) {
    const auto grey = static_cast<std::uint8_t>((255 * shade + (kShades - 1) / 2) / (kShades - 1));
    for (std::size_t k = 0; k < 3; ++k) palette[3 * shade + k] = grey;
  }
  constexpr std::array<std::uint8_t, 3> kViolet{60, 30, 70};
  std::ranges::copy(kViolet, palette.begin() + 3 * kMissing);
  return palette;
}

std::uint8_t shade_of(std::uint16_t dn, const Stretch& stretch) {
  if (dn == kMissingPixel) return kMissing;
  const double span = std::max(stretch.white_dn - stretch.black_dn, 1.0);
  const double place = std::clamp((dn - stretch.black_dn) / span, 0.0, 1.0);
  const double bright = std::asinh(stretch.softness * place) / std::asinh(stretch.softness);
  return static_cast<std::uint8_t>(std::lround(bright * (kShades - 1)));
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

std::vector<std::uint8_t> png_of(const CameraPicture& picture, const Stretch& stretch) {
  const bool has_pixels =
      picture.width > 0 && picture.height > 0 &&
      picture.dn.size() == static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (!has_pixels) throw std::invalid_argument("the number of pixels of a picture must be its width times its height");
  std::vector<std::uint8_t> index;
  index.reserve(picture.dn.size());
  for (const std::uint16_t dn : picture.dn) index.push_back(shade_of(dn, stretch));
  const Palette palette = make_palette();
  return encoded_png(picture.width, picture.height, PNG_FORMAT_RGB_COLORMAP, index.data(), palette.data());
}

std::vector<std::uint8_t> encoded_png(int width, int height, unsigned format, const std::uint8_t* pixels,
                                      const std::uint8_t* palette) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  image.colormap_entries = palette == nullptr ? 0 : 256;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::uint8_t> png(size);
  if (png_image_write_to_memory(&image, png.data(), &size, 0, pixels, 0, palette) == 0)
    throw std::runtime_error("a picture cannot be encoded: " + std::string(image.message));
  png.resize(size);
  return png;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // one for the terminating zero
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(), static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

std::string png_data_uri(std::span<const std::uint8_t> png) {
  return "data:image/png;base64," + base64(png);
}

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
