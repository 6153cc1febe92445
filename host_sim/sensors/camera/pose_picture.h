#pragma once
// What the pose network saw of an image, for the eye: the image, and its crop with the network's heatmaps. The network
// is run again on the crop that telemetry reports: same bits as on board. Marks are drawn by the report.

#include <cstdint>
#include <vector>

#include "fsw/imaging/image.h"
#include "fsw/network/keypoint_network.h"
#include "fsw/packets/messages.h"

namespace vbar::sensors {

/// The crop is enlarged to this width and height, and is placed right of the image.
inline constexpr int kCropPicturePx = 512;
[[nodiscard]] inline int crop_left(int image_width) {
  constexpr int kGap = 8;
  return image_width + kGap;
}

/// Returns a PNG in which noise is black. Without heatmaps if `network` has no weights, without a crop if it cannot be
/// cut out.
[[nodiscard]] std::vector<std::uint8_t> pose_picture(const fsw::imaging::ImageView& image, const telemetry_pose& pose,
                                                     double dark_level_dn, double noise_dn,
                                                     fsw::network::KeypointNetwork& network);

}  // namespace vbar::sensors
