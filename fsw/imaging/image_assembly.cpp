#include "fsw/imaging/image_assembly.h"

#include <algorithm>

#include "fsw/imaging/tile_packing.h"

namespace vbar::fsw::imaging {
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
