#include "host_sim/star_images/star_fix.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

#include <Eigen/Geometry>

#include "fsw/vision/stars/catalogue.h"
#include "fsw/vision/stars/star_identification.h"

namespace vbar::star_images {
namespace {

using fsw::Vector2;
using fsw::Vector3;
namespace imaging = fsw::imaging;
namespace stars = fsw::stars;

constexpr int kCore = 544;   // px of a region that no other region covers; with its margins below kMaxPixels
constexpr int kMargin = 40;  // px: an object that is cut in one region is whole in the next

/// First pixel and number of pixels of a region along one axis.
struct Extent {
  int begin = 0, size = 0;
  double core_begin = 0.0, core_end = 0.0;
};

std::vector<Extent> extents_of(int side) {
  std::vector<Extent> extents;
  const int count = (side + kCore - 1) / kCore;
  for (int k = 0; k < count; ++k) {
    const int first = side * k / count;
    const int last = side * (k + 1) / count;
    const int begin = std::max(0, first - kMargin);
    extents.push_back({begin, std::min(side, last + kMargin) - begin, k == 0 ? -1.0 : first - 0.5,
                       k + 1 == count ? side + 1.0 : last - 0.5});
  }
  return extents;
}

stars::Field field_of(const imaging::CameraModel& camera, int width, int height) {
  const auto direction = [&](double x, double y) {
    const auto result = imaging::direction_of(camera, Vector2(x, y));
    return result.ok() ? result.value() : Vector3(Vector3::UnitZ());
  };
  stars::Field field;
  field.centre_camera = direction(0.5 * width - 0.5, 0.5 * height - 0.5);
  for (const double x : {-0.5, width - 0.5})
    for (const double y : {-0.5, height - 0.5})
      field.radius_rad =
          std::max(field.radius_rad, std::acos(std::clamp(field.centre_camera.dot(direction(x, y)), -1.0, 1.0)));
  return field;
}

/// Magnitude at which the whole catalogue has this share of stars that are brighter, in stars a steradian.
double magnitude_of_density(double stars_a_sr) {
  static const std::vector<double> sorted = [] {
    std::vector<double> magnitudes;
    for (int star = 0; star < stars::catalogue_size(); ++star) magnitudes.push_back(stars::star_magnitude(star));
    std::ranges::sort(magnitudes);
    return magnitudes;
  }();
  const double rank = stars_a_sr * 4.0 * std::numbers::pi;
  return sorted[static_cast<std::size_t>(std::clamp(rank, 0.0, static_cast<double>(sorted.size() - 1)))];
}

/// Magnitude of an object of unit flux.
double zero_point(const ImageObjects& image, double solid_angle_sr) {
  const std::size_t rank = std::min<std::size_t>(20, image.objects.size()) - 1;
  const double flux = std::max(1.0, image.objects[rank].flux_dn);
  return magnitude_of_density(static_cast<double>(rank + 1) / solid_angle_sr) + 2.5 * std::log10(flux);
}

}  // namespace

ImageObjects detect_objects(const GreyImage& image, const imaging::DetectorSettings& settings) {
  ImageObjects result{
      .width = image.width, .height = image.height, .background_dn = 0.0, .noise_dn = 0.0, .objects = {}};
  const auto detector = std::make_unique<imaging::ObjectDetector>();
  std::vector<double> levels, noises;
  for (const Extent& down : extents_of(image.height)) {
    for (const Extent& across : extents_of(image.width)) {
      std::vector<std::uint16_t> pixels;
      for (int y = down.begin; y < down.begin + down.size; ++y) {
        const auto row = image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * image.width + across.begin;
        pixels.insert(pixels.end(), row, row + across.size);
      }
      const imaging::ImageFrame frame{across.size, down.size, across.begin, down.begin, image.bits};
      const imaging::DetectionReport report = detector->detect({frame, pixels}, settings);
      if (report.condition != imaging::ImageCondition::kGood) continue;
      levels.push_back(report.background_dn);
      noises.push_back(report.noise_dn);
      for (const imaging::DetectedObject& object : detector->objects()) {
        const Vector2& at = object.centroid_px;
        const bool is_own = at.x() >= across.core_begin && at.x() < across.core_end && at.y() >= down.core_begin &&
                            at.y() < down.core_end;
        if (is_own) result.objects.push_back(object);
      }
    }
  }
  std::ranges::sort(result.objects, std::greater<>(), &imaging::DetectedObject::flux_dn);
  if (result.objects.size() > imaging::kMaxObjects) result.objects.resize(imaging::kMaxObjects);
  const auto median = [](std::vector<double>& values) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    return values[values.size() / 2];
  };
  result.background_dn = median(levels);
  result.noise_dn = median(noises);
  return result;
}

std::optional<StarFix> identify(const ImageObjects& image, const FixSettings& settings) {
  if (image.objects.empty()) return std::nullopt;
  const double per_px = 1.0 / settings.camera.focal_length_px.x();
  const double zero = zero_point(image, image.width * image.height * per_px * per_px);
  std::vector<stars::ObservedStar> seen;
  for (const imaging::DetectedObject& object : image.objects) {
    const auto direction = imaging::direction_of(settings.camera, object.centroid_px);
    seen.push_back({direction.ok() ? direction.value() : Vector3(Vector3::UnitZ()),
                    std::hypot(object.sigma_px, settings.centroid_floor_px) * per_px,
                    zero - 2.5 * std::log10(std::max(1.0, object.flux_dn))});
  }
  const auto identifier = std::make_unique<stars::StarIdentifier>();
  const Vector3& velocity = settings.velocity_over_c_eci;
  const stars::Field field = field_of(settings.camera, image.width, image.height);
  if (identifier->lost_in_space(seen, field, velocity) != fsw::Status::kOk) return std::nullopt;
  const stars::AttitudeFix& found = identifier->fix();
  StarFix fix{.R_camera_eci = found.R_camera_eci,
              .sigma_rad = found.sigma_rad,
              .sigma_roll_rad = found.sigma_roll_rad,
              .log_chance = found.log_chance,
              .stars = {}};
  for (const stars::StarMatch& match : std::span(found.match).first(static_cast<std::size_t>(found.matches))) {
    SeenStar star;
    star.hipparcos = stars::star_hipparcos(match.catalogue);
    star.pixel = image.objects[static_cast<std::size_t>(match.object)].centroid_px;
    star.magnitude = stars::star_magnitude(match.catalogue);
    star.direction_eci = (stars::star_direction_eci(match.catalogue) + velocity).normalized();
    const auto pixel = imaging::pixel_of(settings.camera, fix.R_camera_eci * star.direction_eci);
    if (!pixel.ok()) continue;
    star.residual_px = star.pixel - pixel.value();
    fix.stars.push_back(star);
  }
  return fix;
}

double residual_rms_px(const StarFix& fix) {
  double sum = 0.0;
  for (const SeenStar& star : fix.stars) sum += star.residual_px.squaredNorm();
  return fix.stars.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(fix.stars.size()));
}

}  // namespace vbar::star_images
