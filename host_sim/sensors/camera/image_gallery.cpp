#include "host_sim/sensors/camera/image_gallery.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "fsw/vision/target_tracking/angles_only_tracking.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/plots/png.h"
#include "host_sim/report/words.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_truth.h"
#include "host_sim/sensors/camera/make_camera.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::sensors {

namespace {

constexpr std::uint16_t kMissing = 0xFFFF;
constexpr double kSigmaOfMad = 1.4826;  // factor of a normal distribution
constexpr double kShownFrom_sigma = 5.0;
constexpr int kHalfWindow = 4;  // px, of a centroid

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The differences of the pixels that both images have.
std::vector<double> differences(const ImagePair& pair) {
  std::vector<double> all;
  for (std::size_t k = 0; k < pair.testbed.size(); ++k)
    if (pair.testbed[k] != kMissing) all.push_back(static_cast<double>(pair.testbed[k]) - pair.twin[k]);
  return all;
}

struct Noise {
  double median_dn = 0.0, sigma_dn = 0.0;
};

Noise noise_of(const ImagePair& pair) {
  std::vector<double> all = differences(pair);
  const double middle = median(all);
  for (double& value : all) value = std::abs(value - middle);
  // Whole numbers: identical images have no deviation, and one step of the converter is no feature.
  return {middle, std::max(kSigmaOfMad * median(std::move(all)), 0.5)};
}

/// Centroid of the light above the median of a window about a place; empty at the edge, without light and with missing
/// pixels.
std::optional<Eigen::Vector2d> centroid(const ImagePair& pair, std::span<const std::uint16_t> dn, double x_px,
                                        double y_px) {
  const int x0 = static_cast<int>(std::lround(x_px)) - pair.origin_x_px;
  const int y0 = static_cast<int>(std::lround(y_px)) - pair.origin_y_px;
  if (x0 < kHalfWindow || y0 < kHalfWindow || x0 + kHalfWindow >= pair.width || y0 + kHalfWindow >= pair.height)
    return std::nullopt;
  const auto at = [&](int x, int y) { return dn[static_cast<std::size_t>(y * pair.width + x)]; };
  std::vector<double> window;
  for (int y = y0 - kHalfWindow; y <= y0 + kHalfWindow; ++y)
    for (int x = x0 - kHalfWindow; x <= x0 + kHalfWindow; ++x) {
      if (at(x, y) == kMissing) return std::nullopt;
      window.push_back(at(x, y));
    }
  const double background = median(window);
  double sum = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (int y = y0 - kHalfWindow; y <= y0 + kHalfWindow; ++y)
    for (int x = x0 - kHalfWindow; x <= x0 + kHalfWindow; ++x) {
      const double light = std::max(at(x, y) - background, 0.0);
      sum += light;
      moment += light * Eigen::Vector2d(x, y);
    }
  if (!(sum > 0.0)) return std::nullopt;
  return moment / sum;
}

}  // namespace

TakeTwinImage twin_of_testbed_camera(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                     const mission::Sensor& sensor) {
  if (testbeds::find_testbed(sensor.settings->source) == nullptr) return {};
  struct Twin {
    std::unique_ptr<twins::camera::ImageMaker> camera;
    twins::camera::CameraMount mount;
  };
  return [twin = std::make_shared<Twin>(), &mission, &servicer, &sensor](const twins::TruthSnapshot& truth,
                                                                         std::int64_t number) {
    if (!twin->camera) {
      const auto data = mission::data_directory();
      const CameraSensor known = known_camera(settings_of<CameraSensor>(sensor), mission, data).sensor;
      twin->mount = mount_of(mission, servicer, known, data);
      mission::Sensor calibrated = sensor;
      calibrated.settings = std::make_shared<const CameraSensor>(known);
      twin->camera = make_digital_camera(mission, servicer, calibrated, data);
    }
    return twin->camera->take(twins::camera::exposure_of_truth(twin->mount, truth, number)).dn;
  };
}

std::vector<std::uint8_t> difference_png(const ImagePair& pair) {
  const Noise noise = noise_of(pair);
  report::ColourPicture picture(pair.width, pair.height);
  for (int y = 0; y < pair.height; ++y)
    for (int x = 0; x < pair.width; ++x) {
      const auto k = static_cast<std::size_t>(y * pair.width + x);
      if (pair.testbed[k] == kMissing) continue;
      const double difference = static_cast<double>(pair.testbed[k]) - pair.twin[k] - noise.median_dn;
      const double size = std::abs(difference) / noise.sigma_dn;
      if (size < kShownFrom_sigma) continue;
      // The scale is logarithmic: from a third of the brightness to full brightness at a hundred times the limit.
      const double share = std::min(1.0 / 3.0 + std::log10(size / kShownFrom_sigma) / 3.0, 1.0);
      const auto strong = static_cast<std::uint8_t>(std::lround(255.0 * share));
      const auto weak = static_cast<std::uint8_t>(strong / 3);
      picture.set(x, y, difference > 0.0 ? report::Colour{strong, weak, weak} : report::Colour{weak, weak, strong});
    }
  return picture.png();
}

std::optional<Eigen::Vector2d> target_shift_px(const ImagePair& pair, const telemetry_objects& objects) {
  std::vector<double> stars_x, stars_y;
  std::optional<Eigen::Vector2d> target;
  const int count = std::min<int>(objects.count, std::size(objects.kind));
  for (int k = 0; k < count; ++k) {
    const auto in_testbed =
        centroid(pair, pair.testbed, static_cast<double>(objects.x_px[k]), static_cast<double>(objects.y_px[k]));
    const auto in_twin =
        centroid(pair, pair.twin, static_cast<double>(objects.x_px[k]), static_cast<double>(objects.y_px[k]));
    if (!in_testbed || !in_twin) continue;
    const Eigen::Vector2d shift = *in_testbed - *in_twin;
    if (objects.kind[k] == telemetry_objects::kKindTarget) target = shift;
    if (objects.kind[k] != telemetry_objects::kKindStar) continue;
    stars_x.push_back(shift.x());
    stars_y.push_back(shift.y());
  }
  if (!target || stars_x.empty()) return std::nullopt;
  return *target - Eigen::Vector2d(median(stars_x), median(stars_y));
}

std::string difference_text(const ImagePair& pair, const ImageRow& row, const telemetry_objects* objects,
                            double focal_length_px) {
  const Noise noise = noise_of(pair);
  std::string text = fmt::format("median {:.1f} DN, noise {:.1f} DN", noise.median_dn, noise.sigma_dn);
  const auto shift_px = objects != nullptr ? target_shift_px(pair, *objects) : std::nullopt;
  if (!shift_px || !row.bearing_error_x_arcsec) return text;
  const Eigen::Vector2d error(*row.bearing_error_x_arcsec, row.bearing_error_y_arcsec.value_or(0.0));
  const Eigen::Vector2d of_twin = error - *shift_px / focal_length_px / fsw::math::kArcsecond;
  return text + fmt::format(", bearing error {:.1f}, {:.1f} arcsec, in the image of the twin {:.1f}, {:.1f} arcsec",
                            error.x(), error.y(), of_twin.x(), of_twin.y());
}

namespace {

using fsw::GpsTime;
using fsw::target_tracking::SightingStatus;

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

GalleryRecorder::GalleryRecorder(const mission::Mission& mission, const mission::Spacecraft& servicer,
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
bool GalleryRecorder::may_be_wanted(GpsTime now) const {
  return !has_bearing_ || std::ranges::any_of(moments_, [&](GpsTime moment) {
    return now >= moment - before_ && now <= moment + before_;
  });
}

std::optional<GpsTime> GalleryRecorder::moment_of(GpsTime exposure) const {
  const auto moment = std::ranges::lower_bound(moments_, exposure);
  if (moment == moments_.end() || exposure <= *moment - before_) return std::nullopt;
  return *moment;
}

void GalleryRecorder::on_inputs(GpsTime now, std::span<const twins::Packet> inputs) {
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

void GalleryRecorder::on_image(const ImageFindings& found, std::vector<report::GalleryImage>& gallery) {
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

void GalleryRecorder::finish(std::vector<report::GalleryImage>& gallery) {
  if (best_) gallery.push_back(picture(*best_));
  best_.reset();
}

GalleryRecorder::Candidate GalleryRecorder::candidate(const ImageFindings& found, GpsTime moment) const {
  const fsw::imaging::ImageView view = assembly_->view();
  Candidate candidate{moment, found.row, view.frame, {view.pixels.begin(), view.pixels.end()}, {}, {}};
  if (!take_twin_) return candidate;
  if (found.objects != nullptr) candidate.objects = *found.objects;
  if (found.truth != nullptr) candidate.truth = *found.truth;
  return candidate;
}

report::GalleryImage GalleryRecorder::picture(const Candidate& candidate) const {
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
void GalleryRecorder::add_twin(const Candidate& candidate, const report::Stretch& stretch,
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
