#pragma once
// What the pose network made of an image, for the eye: the image with its crop, and the crop with the network's maps
// and the keypoints that came of them. The network is run again on the crop that telemetry names: same bits as on
// board.

#include <cstdint>
#include <vector>

#include "fsw/imaging/image.h"
#include "fsw/network/keypoint_network.h"
#include "fsw/packets/messages.h"

namespace vbar::app {

/// A PNG; what is no more than noise is black in it. Without the maps where `network` has no weights or the crop cannot
/// be cut out.
[[nodiscard]] std::vector<std::uint8_t> pose_picture(const fsw::imaging::ImageView& image, const telemetry_pose& pose,
                                                     double dark_level_dn, double noise_dn,
                                                     fsw::network::KeypointNetwork& network);

}  // namespace vbar::app
