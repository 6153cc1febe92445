#include "host_sim/sensors/camera/pose_gallery.h"

#include <string>

#include <fmt/format.h>

#include "fsw/pose/spacecraft_pose_network.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/code_names.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/pose_picture.h"

namespace vbar::sensors {
namespace {

std::string caption(const PoseRow& row) {
  std::string text = row.range_m ? fmt::format("true range {:.1f} m, ", *row.range_m) : "";
  text += report::pose_sighting_name(row.status);
  if (row.pnp_inliers > 0) text += fmt::format(" by {} keypoints", row.pnp_inliers);
  if (row.pnp_error_deg) text += fmt::format(", PnP {:.1f} deg off", *row.pnp_error_deg);
  if (row.attitude_error_deg) text += fmt::format(", filter {:.1f} deg off", *row.attitude_error_deg);
  if (row.sunlit && *row.sunlit < 1.0) text += fmt::format(", {:.0f} % of the Sun in sight", 100.0 * *row.sunlit);
  return text;
}

}  // namespace

PoseGallery::PoseGallery(const mission::Mission& mission, const mission::Spacecraft& servicer, std::uint8_t unit) {
  const auto* const camera = navigation_camera(servicer, unit);
  if (camera == nullptr || !camera->has_use(CameraSensor::kKeypoints)) return;
  work_ = std::make_unique<Work>();
  static_cast<void>(work_->network.load(fsw::network::weights_on_board()));  // without it, pictures without maps
  work_->assembly = fsw::imaging::ImageAssembly(unit);
  const camera_configuration configuration = camera_configuration_of(*camera);
  dark_level_dn_ = configuration.dark_level_dn;
  noise_dn_ = configuration.noise_dn;
  for (int k = 0; k < kPictures; ++k)
    moments_.push_back(mission.start_time() + fsw::Duration{mission.duration.ns / kPictures * k});
}

void PoseGallery::on_inputs(fsw::GpsTime now, std::span<const twins::Packet> inputs) {
  if (!work_ || next_ == moments_.size() || now < moments_[next_]) return;
  for (const twins::Packet& bytes : inputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    const auto tile = fsw::packets::decode<image_tile>(packet.value());
    if (!tile.ok()) continue;
    // The flight software rejects what this assembly rejects, and reports it.
    static_cast<void>(work_->assembly.take(packet.value().header.time, packet.value().header.unit, tile.value()));
  }
}

void PoseGallery::on_pose(fsw::GpsTime exposure, const telemetry_pose& pose, const PoseRow& row,
                          std::vector<report::GalleryImage>& gallery) {
  if (!work_ || next_ == moments_.size() || exposure < moments_[next_]) return;
  if (pose.status == static_cast<int>(fsw::pose::SightingStatus::kDark)) return;  // a black picture shows nothing
  const fsw::imaging::ImageAssembly& assembly = work_->assembly;
  if (!assembly.has_image() || assembly.image_time() != exposure || assembly.image_number() != pose.image) return;
  const fsw::imaging::ImageFrame& frame = assembly.view().frame;
  gallery.push_back({.time_s = row.time_s,
                     .image = row.image,
                     .caption = caption(row),
                     .origin_x_px = frame.origin_x,
                     .origin_y_px = frame.origin_y,
                     .width_px = frame.width,
                     .height_px = frame.height,
                     .crop_left = crop_left(frame.width),
                     .crop_side = kCropPicturePx,
                     .png = pose_picture(assembly.view(), pose, dark_level_dn_, noise_dn_, work_->network)});
  while (next_ < moments_.size() && exposure >= moments_[next_]) ++next_;
}

}  // namespace vbar::sensors
