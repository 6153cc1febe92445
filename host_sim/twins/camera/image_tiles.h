#pragma once
// An image as packets of the flight software.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

/// Returns the number of an image in its packets.
constexpr std::int32_t image_number_on_link(std::int64_t exposure_number) {
  return static_cast<std::int32_t>(exposure_number & 0x7FFFFFFF);
}

/// Identifies an image and its receiver.
struct ImageLabel {
  fsw::GpsTime time;            ///< middle of the exposure
  std::int64_t number = 0;      ///< number of the exposure, 0 or above; the link counts it modulo 2^31
  std::uint8_t spacecraft = 0;  ///< whose flight software receives it
  std::uint8_t unit = 0;        ///< number of the camera
  double exposure_s = 0.0;      ///< its duration
};

/// Returns the number of tiles of an image; empty for bits other than 8 and 12, for a region without pixels or outside
/// what the message can state, and for one that makes more tiles than their numbers can count.
[[nodiscard]] std::optional<int> number_of_tiles(const Region& region, int bits);

/// Splits an image into packets. `dn`: the pixels of `region`, rows from the top, of `bits` (8 or 12) each. One packet
/// a tile, in order; sequence counts are those of a camera that has sent all its earlier images whole. Throws
/// std::invalid_argument for other bits, for pixels that are not those of the region and for a region without a
/// number_of_tiles().
std::vector<Packet> image_tiles(const ImageLabel& label, const Region& region, int bits,
                                std::span<const std::uint16_t> dn);

}  // namespace vbar::twins::camera
