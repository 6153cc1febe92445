#pragma once
// Assembly of one camera's image from its tiles. The image at the step is that of the latest time of which a tile has
// arrived; the result does not depend on the order in which tiles arrive.

#include <array>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/imaging/image.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::imaging {

/// Since the assembly was made.
struct AssemblyCounts {
  std::int32_t tiles_refused = 0;     ///< all that are in no image: invalid, late, duplicate, or of an abandoned image
  std::int32_t tiles_duplicated = 0;  ///< of those, received twice with the same content
  std::int32_t images_abandoned = 0;  ///< replaced by a later one before they were used
  std::int32_t images_spoiled = 0;    ///< with two contradicting tiles
};

class ImageAssembly {
 public:
  /// `unit`: which camera, as in the header of its packets.
  explicit ImageAssembly(std::uint8_t unit = 0) : unit_(unit) {}

  /// Tiles later than this are refused (at the start none): a tile of the future would otherwise block all before it.
  void accept_until(GpsTime latest) { latest_ = latest; }

  /// Files a tile under its packet's time. A later time than that of the image there starts a new image. Refuses:
  ///   kWrongType        another unit
  ///   kInvalidArgument  fields that are invalid, or that contradict the tiles before. Then neither can be trusted
  ///                     and the image is spoiled: has_image() is false until a later one begins
  ///   kOutOfRange       more pixels than kMaxPixels or kMaxSide, or a time later than accept_until()
  ///   kBadSequence      of an image used, replaced or spoiled already, or there already
  [[nodiscard]] Status take(GpsTime time, std::uint8_t unit, const image_tile& tile);

  /// At least one tile of an image has arrived, and none contradicts another.
  [[nodiscard]] bool has_image() const { return tiles_there_ > 0; }
  /// Pixels of missing tiles are kMissingPixel. Empty without an image, and valid until the next take().
  [[nodiscard]] ImageView view() const;
  [[nodiscard]] GpsTime image_time() const { return time_; }
  [[nodiscard]] std::int32_t image_number() const { return number_; }
  /// Duration of the exposure; 0: not stated.
  [[nodiscard]] double exposure_s() const { return static_cast<double>(exposure_s_); }
  [[nodiscard]] int tiles_missing() const { return tiles_ - tiles_there_; }

  /// The image has been used: it is discarded, and tiles of its time or before are refused from now on.
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
  GpsTime time_{INT64_MIN};  ///< of the current image, or of the last one
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
