#pragma once
// An exposure as bytes, for a log: with the camera's settings and the seed it determines the image.

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::twins::camera {

/// Limits of an LCM message vbar_host.image_recipe.
inline constexpr std::size_t kMaxObjectsInView = 8;
inline constexpr std::size_t kMaxNameBytes = 63;

/// Returns whether a number of a logged message fits its field in the header of a packet.
constexpr bool fits_header(std::int16_t number) {
  return number >= 0 && number <= std::numeric_limits<std::uint8_t>::max();
}

/// An exposure, and the headers of its packets.
struct ImageRecipe {
  std::uint8_t spacecraft = 0;
  std::uint8_t unit = 0;
  Exposure exposure;
};

/// Encodes the LCM message. Throws std::invalid_argument for more than kMaxObjectsInView objects and for a name of an
/// object or a model longer than kMaxNameBytes.
[[nodiscard]] std::vector<std::uint8_t> bytes_of(const ImageRecipe& recipe);

/// Decodes the recipe, every number to the last bit; empty if the bytes are not exactly one such message.
[[nodiscard]] std::optional<ImageRecipe> recipe_of(std::span<const std::uint8_t> bytes);

// An image with its pixels as bytes, for a log: lossless by JPEG-LS (ISO/IEC 14495-1). With the noise of the digital
// camera 500 x 800 pixels of 12 bits take some 120 kB.

/// Properties of an image apart from its pixels.
struct ImageHeader {
  ImageLabel label;
  Region region;
  int bits = 12;  ///< bits of a pixel, 8 or 12

  [[nodiscard]] ImageKey key() const { return {label.spacecraft, label.unit, image_number_on_link(label.number)}; }
};

/// Encodes the LCM message vbar_host.recorded_image. `dn`: the pixels of the region, rows from the top. Throws
/// std::invalid_argument for pixels that are not those of the region or exceed their bits, and for an image that
/// image_tiles() rejects.
[[nodiscard]] std::vector<std::uint8_t> recorded_image_of(const ImageHeader& header, std::span<const std::uint16_t> dn);

/// Decodes the header; empty if the bytes are not exactly one such message of an image that image_tiles() accepts. The
/// pixels are not decoded.
[[nodiscard]] std::optional<ImageHeader> header_of_recorded_image(std::span<const std::uint8_t> recorded_image);

/// Decodes the pixels. Throws std::runtime_error, a clause without a subject ("holds damaged JPEG-LS data: ..."), if
/// the JPEG-LS data are damaged or of another size, number of bits or coding than the message states.
[[nodiscard]] std::vector<std::uint16_t> pixels_of_recorded_image(std::span<const std::uint8_t> recorded_image);

// The tiles of images that a log holds as recipes or recordings.

/// Restores the tiles from the recorded pixels or, without these, by rendering the image of the recipe. One image at a
/// time is kept as packets.
class TileRestorer final : public TileSource {
 public:
  /// The packets of an image, all its tiles in order.
  using MakeImage = std::function<std::vector<Packet>(const ImageRecipe&)>;

  /// Throws DamagedLog, which names the file, for a damaged recipe or recording; the pixels of recordings are decoded
  /// when they are needed.
  TileRestorer(ImagesOfLog&& images, MakeImage make_image);

  /// Restores the packets of a run. Also throws std::runtime_error if the log holds nothing of the image, or if the
  /// checksum of the restored tiles differs from that of the tiles in the recorded run.
  std::vector<Packet> packets_of(const TileRun& run) override;

  [[nodiscard]] std::vector<fsw::GpsTime> exposures() const override;
  [[nodiscard]] std::optional<LoggedImage> recipe_at(fsw::GpsTime exposure) const override;
  [[nodiscard]] std::optional<LoggedImage> recording_at(fsw::GpsTime exposure) const override;

 private:
  /// Places in the lists of the log.
  struct Image {
    std::optional<std::size_t> recipe, recording;
  };
  void add_recipe(std::size_t place);
  void add_recording(std::size_t place);
  [[nodiscard]] const Image* find(fsw::GpsTime exposure) const;
  [[nodiscard]] std::vector<Packet> all_packets_of(const TileRun& run) const;
  [[nodiscard]] std::vector<Packet> recorded_packets(std::size_t recording, const TileRun& run) const;
  [[noreturn]] void fail(const TileRun& run, const std::string& what) const;

  ImagesOfLog log_;
  MakeImage make_image_;
  std::map<ImageKey, Image> images_;
  std::map<fsw::GpsTime, ImageKey> keys_;  ///< by the time of the exposure
  std::optional<ImageKey> made_;
  std::vector<Packet> packets_;  // packets of that image
};

}  // namespace vbar::twins::camera
