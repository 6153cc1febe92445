#include "fsw/vision/imaging/image_assembly.h"

#include <algorithm>

namespace vbar::fsw::imaging {

namespace {

constexpr std::uint16_t kMax12Bits = 0xFFF;

constexpr std::uint8_t low_byte(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}

bool fits(std::span<const std::uint16_t> pixels, unsigned maximum) {
  unsigned all = 0;  // the maximum is all ones, so that a larger pixel leaves a bit above it
  for (const std::uint16_t pixel : pixels) all |= pixel;
  return all <= maximum;
}

void pack8(std::span<const std::uint16_t> pixels, std::uint8_t* out) {
  for (const std::uint16_t pixel : pixels) *out++ = low_byte(pixel);
}

void pack12(std::span<const std::uint16_t> pixels, std::uint8_t* out) {
  const std::size_t pairs = pixels.size() / 2;
  const std::uint16_t* in = pixels.data();
  for (std::size_t k = 0; k < pairs; ++k, in += 2, out += 3) {
    const unsigned a = in[0];
    const unsigned b = in[1];
    out[0] = low_byte(a >> 4U);
    out[1] = low_byte(a << 4U | b >> 8U);
    out[2] = low_byte(b);
  }
  if (pixels.size() % 2 != 0) {
    const unsigned a = *in;
    out[0] = low_byte(a >> 4U);
    out[1] = low_byte(a << 4U);
  }
}

void unpack8(const std::uint8_t* in, std::span<std::uint16_t> pixels) {
  for (std::uint16_t& pixel : pixels) pixel = *in++;
}

void unpack12(const std::uint8_t* in, std::span<std::uint16_t> pixels) {
  const std::size_t pairs = pixels.size() / 2;
  std::uint16_t* out = pixels.data();
  for (std::size_t k = 0; k < pairs; ++k, in += 3, out += 2) {
    const unsigned middle = in[1];
    out[0] = static_cast<std::uint16_t>(static_cast<unsigned>(in[0]) << 4U | middle >> 4U);
    out[1] = static_cast<std::uint16_t>((middle & 0xFU) << 8U | in[2]);
  }
  if (pixels.size() % 2 != 0) {
    *out = static_cast<std::uint16_t>(static_cast<unsigned>(in[0]) << 4U | static_cast<unsigned>(in[1]) >> 4U);
  }
}

}  // namespace

std::size_t pack_pixels(std::span<const std::uint16_t> pixels, int bits, std::span<std::uint8_t> out) {
  const std::size_t size = packed_size(pixels.size(), bits);
  if (size == 0 || size > out.size() || !fits(pixels, bits == 8 ? 0xFFU : kMax12Bits)) return 0;
  if (bits == 8) {
    pack8(pixels, out.data());
  } else {
    pack12(pixels, out.data());
  }
  return size;
}

std::size_t unpack_pixels(std::span<const std::uint8_t> bytes, int bits, std::span<std::uint16_t> pixels) {
  const std::size_t size = packed_size(pixels.size(), bits);
  if (size == 0 || size > bytes.size()) return 0;
  if (bits == 8) {
    unpack8(bytes.data(), pixels);
  } else {
    unpack12(bytes.data(), pixels);
  }
  return size;
}

namespace {

constexpr float kLongestExposure_s = 3600.0F;

constexpr int pixels_of_tile(int bits) {
  return bits == 8 ? kTilePixels8 : kTilePixels12;
}

constexpr int pixels_of(const image_tile& tile) {
  return int{tile.width} * int{tile.height};
}

/// Returns kOk if the tile's fields are consistent: then its pixels lie within its image and its data within its bytes.
Status check(const image_tile& tile) {
  if (tile.bits != 8 && tile.bits != 12) return Status::kInvalidArgument;
  if (tile.image < 0 || tile.width < 1 || tile.height < 1) return Status::kInvalidArgument;
  if (tile.origin_x < 0 || tile.origin_y < 0) return Status::kInvalidArgument;
  if (!(tile.exposure_s >= 0.0F && tile.exposure_s <= kLongestExposure_s)) return Status::kInvalidArgument;
  const int pixels = pixels_of(tile);
  if (tile.width > kMaxSide || tile.height > kMaxSide || pixels > int{kMaxPixels}) return Status::kOutOfRange;
  const int maximum = pixels_of_tile(tile.bits);
  if (tile.tiles != (pixels + maximum - 1) / maximum) return Status::kInvalidArgument;
  if (tile.tile < 0 || tile.tile >= tile.tiles) return Status::kInvalidArgument;
  if (tile.pixels != std::min(maximum, pixels - tile.tile * maximum)) return Status::kInvalidArgument;
  return Status::kOk;
}

ImageFrame frame_of(const image_tile& tile) {
  return {.width = tile.width,
          .height = tile.height,
          .origin_x = tile.origin_x,
          .origin_y = tile.origin_y,
          .bits = tile.bits};
}

}  // namespace

Status ImageAssembly::take(GpsTime time, std::uint8_t unit, const image_tile& tile) {
  const Status status = file(time, unit, tile);
  if (status != Status::kOk) ++counts_.tiles_refused;
  return status;
}

Status ImageAssembly::file(GpsTime time, std::uint8_t unit, const image_tile& tile) {
  if (unit != unit_) return Status::kWrongType;
  if (time > latest_) return Status::kOutOfRange;
  if (const Status status = check(tile); status != Status::kOk) return status;
  if (time < time_ || (time == time_ && !is_open_)) return Status::kBadSequence;
  if (time > time_) begin(time, tile);
  const auto index = static_cast<std::size_t>(tile.tile);
  const bool is_duplicate = is_there_[index];
  if (!is_of_this_image(tile) || (is_duplicate && !has_same_pixels(tile))) {
    spoil();
    return Status::kInvalidArgument;
  }
  if (is_duplicate) {
    ++counts_.tiles_duplicated;
    return Status::kBadSequence;
  }
  const std::size_t first = index * static_cast<std::size_t>(pixels_of_tile(frame_.bits));
  unpack_pixels(tile.data, frame_.bits, std::span(pixels_).subspan(first, static_cast<std::size_t>(tile.pixels)));
  is_there_[index] = true;
  ++tiles_there_;
  return Status::kOk;
}

void ImageAssembly::begin(GpsTime time, const image_tile& tile) {
  if (tiles_there_ > 0) {
    ++counts_.images_abandoned;
    counts_.tiles_refused += tiles_there_;
  }
  time_ = time;
  is_open_ = true;
  frame_ = frame_of(tile);
  number_ = tile.image;
  exposure_s_ = tile.exposure_s;
  tiles_ = tile.tiles;
  tiles_there_ = 0;
  is_there_.fill(false);
  std::fill_n(pixels_.begin(), pixels_of(tile), kMissingPixel);
}

bool ImageAssembly::is_of_this_image(const image_tile& tile) const {
  return tile.image == number_ && tile.exposure_s == exposure_s_ && frame_of(tile) == frame_;
}

bool ImageAssembly::has_same_pixels(const image_tile& tile) const {
  std::array<std::uint16_t, kTilePixels8> pixels{};  // the larger of the two sizes
  const auto count = static_cast<std::size_t>(tile.pixels);
  const std::size_t first = static_cast<std::size_t>(tile.tile) * static_cast<std::size_t>(pixels_of_tile(frame_.bits));
  unpack_pixels(tile.data, frame_.bits, std::span(pixels).first(count));
  return std::equal(pixels.begin(), pixels.begin() + tile.pixels, pixels_.begin() + static_cast<std::ptrdiff_t>(first));
}

void ImageAssembly::spoil() {
  ++counts_.images_spoiled;
  counts_.tiles_refused += tiles_there_;
  tiles_there_ = 0;
  is_open_ = false;
}

ImageView ImageAssembly::view() const {
  if (!has_image()) return {};
  const auto count = static_cast<std::size_t>(frame_.width) * static_cast<std::size_t>(frame_.height);
  return {frame_, std::span(pixels_).first(count)};
}

void ImageAssembly::clear() {
  is_open_ = false;
  tiles_ = 0;
  tiles_there_ = 0;
}

}  // namespace vbar::fsw::imaging
