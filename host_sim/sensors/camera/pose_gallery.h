#pragma once
// What the pose network saw of an image, for the eye: the image, and its crop with the network's heatmaps. The network
// is run again on the crop that telemetry reports: same bits as on board. Marks are drawn by the report.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/image.h"
#include "fsw/vision/imaging/image_assembly.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_source.h"

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
                                                     fsw::pose::KeypointNetwork& network);

// Keeps a few of a run's images for its report, with the heatmaps of the pose network: the first image with light after
// each of some evenly spaced times.

class PoseGallery {
 public:
  static constexpr int kPictures = 9;

  /// Keeps nothing unless the camera of that unit navigates by poses.
  PoseGallery(const mission::Mission& mission, const mission::Spacecraft& servicer, std::uint8_t unit = 0);

  /// Receives the packets that the flight software got with the step at `now`.
  void on_inputs(fsw::GpsTime now, std::span<const twins::Packet> inputs);

  /// Receives the telemetry of an image and its row, after on_inputs() of the same step.
  void on_pose(fsw::GpsTime exposure, const telemetry_pose& pose, const PoseRow& row,
               std::vector<report::GalleryImage>& gallery);

 private:
  /// Assembly and network, which are large and only of use where there is a pose network.
  struct Work {
    fsw::imaging::ImageAssembly assembly;
    fsw::pose::KeypointNetwork network;
  };

  std::unique_ptr<Work> work_;
  double dark_level_dn_ = 0.0;
  double noise_dn_ = 0.0;
  std::vector<fsw::GpsTime> moments_;  ///< in order
  std::size_t next_ = 0;
};

}  // namespace vbar::sensors
