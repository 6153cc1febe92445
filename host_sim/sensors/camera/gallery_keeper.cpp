#include "host_sim/sensors/camera/gallery_keeper.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "fsw/angles_only/sighting.h"
#include "host_sim/report/code_names.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/true_camera.h"

namespace vbar::sensors {
namespace {

using fsw::GpsTime;
using fsw::angles_only::SightingStatus;

// Radius of the mark about the target, px: larger than the marks of its neighbours, and at close range the apparent
// radius of a spacecraft of this size.
constexpr double kTargetRadius = 13.0;

bool has_bearing(const ImageRow& row) {
  return row.status == static_cast<int>(SightingStatus::kBearing);
}

std::string range_text(double range_m) {
  return range_m < 1e4 ? fmt::format("{:.1f} m", range_m) : fmt::format("{:.2f} km", 1e-3 * range_m);
}

/// The time of the exposure is the report's own to tell.
std::string caption(const ImageRow& row) {
  std::string text = row.range_m ? "true range " + range_text(*row.range_m) + ", " : "";
  text += fmt::format("{} objects, {} stars, {}", row.objects, row.stars, report::sighting_name(row.status));
  if (has_bearing(row)) text += row.fate >= telemetry_image::kEditFilter ? ", used" : ", refused by the filter";
  if (row.tiles_missing > 0) text += fmt::format(", {} tiles missing", row.tiles_missing);
  return text;
}

}  // namespace

GalleryKeeper::GalleryKeeper(const mission::Mission& mission, const mission::Spacecraft& servicer,
                             TakeTwinImage take_twin, std::uint8_t unit)
    : take_twin_(std::move(take_twin)) {
  const auto* const camera = navigation_camera(servicer, unit);
  if (camera == nullptr || !camera->has_use(CameraSensor::kBearings)) return;
  assembly_ = std::make_unique<fsw::imaging::ImageAssembly>(unit);
  before_ = fsw::Duration{kExposuresBefore * camera->images.parts().front().period.ns};
  focal_length_px_ = camera->settings.focal_length_px();
  for (const mission::Waypoint& waypoint : mission.waypoints)
    if (waypoint.time > mission.start_time() && waypoint.time < mission.end_time()) moments_.push_back(waypoint.time);
  moments_.push_back(mission.end_time());
}

// Tiles come after the exposure, so steps after a moment count too.
bool GalleryKeeper::may_be_wanted(GpsTime now) const {
  return !has_bearing_ || std::ranges::any_of(moments_, [&](GpsTime moment) {
    return now >= moment - before_ && now <= moment + before_;
  });
}

std::optional<GpsTime> GalleryKeeper::moment_of(GpsTime exposure) const {
  const auto moment = std::ranges::lower_bound(moments_, exposure);
  if (moment == moments_.end() || exposure <= *moment - before_) return std::nullopt;
  return *moment;
}

void GalleryKeeper::on_inputs(GpsTime now, std::span<const twins::Packet> inputs) {
  if (!assembly_ || !may_be_wanted(now)) return;
  for (const twins::Packet& bytes : inputs) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;
    const auto tile = fsw::packets::decode<image_tile>(packet.value());
    if (!tile.ok()) continue;
    // The flight software rejects what this assembly rejects, and reports it.
    static_cast<void>(assembly_->take(packet.value().header.time, packet.value().header.unit, tile.value()));
  }
}

void GalleryKeeper::on_image(const ImageFindings& found, std::vector<report::GalleryImage>& gallery) {
  if (best_ && found.exposure > best_->moment) finish(gallery);
  const bool is_here = assembly_ && assembly_->has_image() && assembly_->image_time() == found.exposure &&
                       assembly_->image_number() == found.row.image;
  if (!is_here) return;
  if (!has_bearing_ && has_bearing(found.row)) {
    has_bearing_ = true;
    best_.reset();  // candidate of the same moment, without a bearing
    gallery.push_back(picture(candidate(found, found.exposure)));
    return;
  }
  const std::optional<GpsTime> moment = moment_of(found.exposure);
  if (!moment || (best_ && has_bearing(best_->row) && !has_bearing(found.row))) return;
  best_ = candidate(found, *moment);
}

void GalleryKeeper::finish(std::vector<report::GalleryImage>& gallery) {
  if (best_) gallery.push_back(picture(*best_));
  best_.reset();
}

GalleryKeeper::Candidate GalleryKeeper::candidate(const ImageFindings& found, GpsTime moment) const {
  const fsw::imaging::ImageView view = assembly_->view();
  Candidate candidate{moment, found.row, view.frame, {view.pixels.begin(), view.pixels.end()}, {}, {}};
  if (!take_twin_) return candidate;
  if (found.objects != nullptr) candidate.objects = *found.objects;
  if (found.truth != nullptr) candidate.truth = *found.truth;
  return candidate;
}

report::GalleryImage GalleryKeeper::picture(const Candidate& candidate) const {
  const report::CameraPicture picture{candidate.frame.width, candidate.frame.height, candidate.dn};
  const double size_px = candidate.row.range_m ? kSpacecraftRadius_m * focal_length_px_ / *candidate.row.range_m : 0.0;
  const report::Stretch stretch = report::stretch_for(picture);
  report::GalleryImage image{.time_s = candidate.row.time_s,
                             .image = candidate.row.image,
                             .caption = caption(candidate.row),
                             .origin_x_px = candidate.frame.origin_x,
                             .origin_y_px = candidate.frame.origin_y,
                             .width_px = candidate.frame.width,
                             .height_px = candidate.frame.height,
                             .target_radius_px = std::max(kTargetRadius, size_px),
                             .png = report::png_of(picture, stretch)};
  if (take_twin_ && candidate.truth) add_twin(candidate, stretch, image);
  return image;
}

/// A picture that cannot be made does not end the run.
void GalleryKeeper::add_twin(const Candidate& candidate, const report::Stretch& stretch,
                             report::GalleryImage& image) const try {
  const std::vector<std::uint16_t> twin = take_twin_(*candidate.truth, candidate.row.image);
  const fsw::imaging::ImageFrame& frame = candidate.frame;
  if (twin.size() != candidate.dn.size()) throw std::runtime_error("it is not of the same region");
  const ImagePair pair{frame.width, frame.height, frame.origin_x, frame.origin_y, candidate.dn, twin};
  image.twin_png = report::png_of({frame.width, frame.height, twin}, stretch);
  image.difference_png = difference_png(pair);
  image.difference =
      difference_text(pair, candidate.row, candidate.objects ? &*candidate.objects : nullptr, focal_length_px_);
} catch (const std::exception& error) {
  image.caption += fmt::format(" (no image of the digital twin: {})", error.what());
}

}  // namespace vbar::sensors
