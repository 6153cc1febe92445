#pragma once
// Assembly of one camera's image from its tiles. The image at the step is that of the latest time of which a tile has
// arrived; the result does not depend on the order in which tiles arrive.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/image.h"

namespace vbar::fsw::imaging {

// Encoding of pixels in the bytes of a tile (vbar.lcm, image_tile), for both ends of the link. 8 bits: one byte per
// pixel. 12 bits, big-endian: two pixels in three bytes; an odd last one fills its first byte and the upper half of its
// second, whose lower half is zero.

/// Returns the number of bytes for `pixels` pixels of 8 or 12 bits; 0 for any other number of bits.
constexpr std::size_t packed_size(std::size_t pixels, int bits) {
  if (bits == 8) return pixels;
  return bits == 12 ? (3 * pixels + 1) / 2 : 0;
}

/// Writes packed_size() bytes to the front of `out` and returns their number; 0, and nothing written, if `out` is too
/// small, `bits` neither 8 nor 12 or a pixel needs more than `bits`.
std::size_t pack_pixels(std::span<const std::uint16_t> pixels, int bits, std::span<std::uint8_t> out);

/// Fills `pixels` from the front of `bytes` and returns the number of bytes read; 0, and nothing written, if there are
/// too few or `bits` is neither 8 nor 12.
std::size_t unpack_pixels(std::span<const std::uint8_t> bytes, int bits, std::span<std::uint16_t> pixels);

/// Counts since the assembly was made.
struct AssemblyCounts {
  std::int32_t tiles_refused = 0;     ///< all that are in no image: invalid, late, duplicate, or of an abandoned image
  std::int32_t tiles_duplicated = 0;  ///< rejected tiles that were received twice with the same content
  std::int32_t images_abandoned = 0;  ///< replaced by a later one before they were used
  std::int32_t images_spoiled = 0;    ///< with two contradicting tiles
};

class ImageAssembly {
 public:
  /// `unit` is the number of the camera in the header of its packets.
  explicit ImageAssembly(std::uint8_t unit = 0) : unit_(unit) {}

  /// Sets the latest time of accepted tiles (at the start none is accepted): a tile of the future would otherwise block
  /// all before it.
  void accept_until(GpsTime latest) { latest_ = latest; }

  /// Files a tile under its packet's time. A later time than that of the present image starts a new image. Rejects:
  ///   kWrongType        another unit
  ///   kInvalidArgument  fields that are invalid, or that contradict the tiles before. Then neither can be trusted
  ///                     and the image is spoiled: has_image() is false until a later one begins
  ///   kOutOfRange       more pixels than kMaxPixels or kMaxSide, or a time later than accept_until()
  ///   kBadSequence      a tile of an image used, replaced or spoiled already, or a tile received already
  [[nodiscard]] Status take(GpsTime time, std::uint8_t unit, const image_tile& tile);

  /// Returns true if at least one tile of an image has arrived, and none contradicts another.
  [[nodiscard]] bool has_image() const { return tiles_there_ > 0; }
  /// Returns the image; pixels of missing tiles are kMissingPixel. Empty without an image, and valid until the next
  /// take().
  [[nodiscard]] ImageView view() const;
  [[nodiscard]] GpsTime image_time() const { return time_; }
  [[nodiscard]] std::int32_t image_number() const { return number_; }
  /// Duration of the exposure; 0: not stated.
  [[nodiscard]] double exposure_s() const { return static_cast<double>(exposure_s_); }
  [[nodiscard]] int tiles_missing() const { return tiles_ - tiles_there_; }

  /// Discards the image after its use; tiles of its time or before are rejected from now on.
  void clear();

  [[nodiscard]] const AssemblyCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kMaxTiles = (kMaxPixels + kTilePixels12 - 1) / kTilePixels12;

  [[nodiscard]] Status file(GpsTime time, std::uint8_t unit, const image_tile& tile);
  void begin(GpsTime time, const image_tile& tile);
  [[nodiscard]] bool is_of_this_image(const image_tile& tile) const;
  [[nodiscard]] bool has_same_pixels(const image_tile& tile) const;
  void spoil();

  std::uint8_t unit_;
  GpsTime latest_{INT64_MAX};
  GpsTime time_{INT64_MIN};  ///< time of the current image, or of the last one
  bool is_open_ = false;     ///< tiles of that time are still accepted
  ImageFrame frame_;
  std::int32_t number_ = 0;
  float exposure_s_ = 0.0F;
  int tiles_ = 0;
  int tiles_there_ = 0;
  std::array<bool, kMaxTiles> is_there_{};
  std::array<std::uint16_t, kMaxPixels> pixels_{};
  AssemblyCounts counts_;
};

}  // namespace vbar::fsw::imaging
