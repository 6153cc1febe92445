#pragma once
// An image with its pixels as bytes, for a log: lossless by JPEG-LS (ISO/IEC 14495-1). With the noise of the digital
// camera 500 x 800 pixels of 12 bits take some 120 kB.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/image_tiles.h"

namespace vbar::twins::camera {

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

}  // namespace vbar::twins::camera
