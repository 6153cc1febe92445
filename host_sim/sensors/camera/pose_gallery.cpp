#include "host_sim/sensors/camera/pose_gallery.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>

#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/spacecraft_pose_network.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/plots/png.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::sensors {

namespace {

using fsw::Status;
using fsw::Vector2;
using fsw::pose::CropRegion;
using fsw::pose::kCropSide;
using fsw::pose::kKeypoints;
using fsw::pose::kMapSide;
using report::Colour;
using report::ColourPicture;

constexpr int kSamplePx = kCropPicturePx / kCropSide;
constexpr int kCellPx = kSamplePx * kCropSide / kMapSide;

/// Eleven hues around the circle, neighbours in number far apart in hue.
Colour colour_of(int keypoint) {
  const double hue = std::fmod(keypoint * 4.0, kKeypoints) / kKeypoints * 6.0;
  const auto channel = [&](double shift) {
    const double away = std::abs(std::remainder(hue - shift, 6.0));
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(2.0 - away, 0.0, 1.0)));
  };
  return {channel(0.0), channel(2.0), channel(4.0)};
}

void set_grey(ColourPicture& picture, int x, int y, double share) {
  const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
  picture.set(x, y, {grey, grey, grey});
}

/// Roots of the light, as the network gets them; all but the brightest thousandth below white.
void draw_image(const fsw::imaging::ImageView& image, double black_dn, ColourPicture& picture) {
  std::vector<std::uint16_t> sorted(image.pixels.begin(), image.pixels.end());
  std::erase(sorted, fsw::imaging::kMissingPixel);
  if (sorted.empty()) return;
  const auto bright = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 999 / 1000);
  std::ranges::nth_element(sorted, bright);
  const double white = std::max(*bright - black_dn, 20.0);
  for (int y = 0; y < image.frame.height; ++y)
    for (int x = 0; x < image.frame.width; ++x) {
      const std::uint16_t dn = image.pixels[static_cast<std::size_t>(y * image.frame.width + x)];
      if (dn == fsw::imaging::kMissingPixel)
        picture.set(x, y, {60, 30, 70});
      else
        set_grey(picture, x, y, std::sqrt(std::max(dn - black_dn, 0.0) / white));
    }
}

void draw_crop(std::span<const float> samples, int left, ColourPicture& picture) {
  const float most = std::max(*std::ranges::max_element(samples), 1.0F);
  for (int y = 0; y < kCropPicturePx; ++y)
    for (int x = 0; x < kCropPicturePx; ++x) {
      const auto sample = static_cast<std::size_t>(y / kSamplePx * kCropSide + x / kSamplePx);
      set_grey(picture, left + x, y, static_cast<double>(samples[sample] / most));
    }
}

/// Each map over its own highest cell.
void draw_map(std::span<const float> logits, const Colour& colour, double strength, int left, ColourPicture& picture) {
  constexpr double kLeast = 0.02;
  const float most = *std::ranges::max_element(logits);
  for (int cell = 0; cell < kMapSide * kMapSide; ++cell) {
    const double share = std::exp(static_cast<double>(logits[static_cast<std::size_t>(cell)] - most));
    if (share < kLeast) continue;
    const int x0 = left + cell % kMapSide * kCellPx, y0 = cell / kMapSide * kCellPx;
    for (int y = 0; y < kCellPx; ++y)
      for (int x = 0; x < kCellPx; ++x) picture.blend(x0 + x, y0 + y, colour, strength * share);
  }
}

}  // namespace

std::vector<std::uint8_t> pose_picture(const fsw::imaging::ImageView& image, const telemetry_pose& pose,
                                       double dark_level_dn, double noise_dn, fsw::pose::KeypointNetwork& network) {
  const fsw::imaging::ImageFrame& frame = image.frame;
  const int left = crop_left(frame.width);
  ColourPicture picture(left + kCropPicturePx, std::max<int>(frame.height, kCropPicturePx));
  constexpr double kNoiseSigmas = 4.0;
  draw_image(image, dark_level_dn + kNoiseSigmas * noise_dn, picture);
  const CropRegion region{Vector2(pose.region_px[0], pose.region_px[1]), pose.region_px[2]};
  const auto samples = std::make_unique<fsw::pose::CropSamples>();
  if (fsw::pose::cut_crop(image, region, dark_level_dn, *samples, false) != Status::kOk) return picture.png();
  draw_crop(*samples, left, picture);
  if (fsw::pose::cut_crop(image, region, dark_level_dn, *samples) == Status::kOk &&
      network.run(*samples) == Status::kOk)
    for (int k = 0; k < kKeypoints; ++k) {
      constexpr double kStrong = 0.65, kFaint = 0.15;
      draw_map(network.logits(k), colour_of(k), pose.keypoint_fate[k] != 0 ? kStrong : kFaint, left, picture);
    }
  return picture.png();
}

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
  static_cast<void>(work_->network.load(fsw::pose::weights_on_board()));  // without it, pictures without maps
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
