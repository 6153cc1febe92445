#include "host_sim/twins/camera/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/twins/camera/object_view.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/star_sky.h"
#include "host_sim/twins/camera/sun_moon_discs.h"

namespace vbar::twins::camera {
namespace {

using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;

constexpr double kMarginPx = 64.0;      // light from beside the region that reaches into it
constexpr double kLargestObject = 5.0;  // m, of its farthest part from its origin
constexpr double kDegree = M_PI / 180.0;

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

bool is_on(const DetectorSettings& detector, const Vector2& pixel) {
  return pixel.x() >= -0.5 && pixel.x() < detector.width - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() < detector.height - 0.5;
}

}  // namespace

struct SceneRenderer::View {
  View(const Exposure& from, const CameraSettings& settings, const Projection& projection, const Cone& detector_cone)
      : exposure(from),
        R_camera_eci(from.q_camera_eci.normalized().toRotationMatrix()),
        earth(from.camera_position_eci, from.sun_eci),
        sun(from.sun_eci - from.camera_position_eci),
        moon(from.moon_eci - from.camera_position_eci),
        sun_photons(camera::sun_photons(settings.zero_magnitude_photons, sun.norm())),
        pixel_rad(1.0 / projection.focal_length_px()),
        moon_radius(std::asin(std::min(1.0, kMoonRadiusM / moon.norm()))) {
    earth_in_field = angle_between(R_camera_eci * earth.centre_direction_eci(), detector_cone.axis) <
                     earth.angular_radius() + detector_cone.half_angle;
  }

  /// Fraction of the light from `direction_eci` that the Earth does not block, 0 to 1.
  [[nodiscard]] double passed_by_earth(const Vector3& direction_eci) const {
    return 1.0 - earth.look(direction_eci, pixel_rad).covered;
  }

  const Exposure& exposure;
  Matrix3 R_camera_eci;
  EarthDisc earth;
  Vector3 sun, moon;  // from the camera, ECI, m
  double sun_photons;
  double pixel_rad;
  double moon_radius;  // rad
  bool earth_in_field = false;
};

SceneRenderer::SceneRenderer(const CameraSettings& settings, const std::filesystem::path& data_directory,
                             ObjectRenderer objects, ObjectCover covers, std::shared_ptr<const Projection> projection)
    : settings_(settings),
      projection_(projection ? std::move(projection) : std::make_shared<const Optics>(settings)),
      spread_(settings.optics),
      sky_(StarSky::load(data_directory / settings.star_catalogue_file, settings.zero_magnitude_photons)),
      objects_(objects ? std::move(objects) : lambert_sphere(0.35, 0.3)),
      covers_(std::move(covers)),
      region_directions_(projection_),
      region_cone_(projection_->cone_of(settings.region, kMarginPx)),
      detector_cone_(projection_->cone_of({0, 0, settings.detector.width, settings.detector.height}, kMarginPx)) {}

void SceneRenderer::render(const Exposure& exposure, PhotonImage& image) {
  image.region = settings_.region;
  image.electrons.assign(
      static_cast<std::size_t>(settings_.region.width) * static_cast<std::size_t>(settings_.region.height), 0.0F);
  duration_s_ = exposure.duration_s.value_or(settings_.exposure_s);
  const View view(exposure, settings_, *projection_, detector_cone_);
  add_stars(view, image);
  const bool one_hides =
      std::ranges::any_of(exposure.objects, [&](const ObjectInView& object) { return hides(view, object); });
  const auto add_objects = [&] {
    for (const ObjectInView& object : exposure.objects) add_object(view, object, image);
  };
  if (!one_hides) add_objects();
  double scattered = add_sun_and_moon(view, image);
  if (view.earth_in_field) scattered += add_earth(view, image);
  if (one_hides) {
    for (const ObjectInView& object : exposure.objects) hide_behind(view, object, image);
    add_objects();
  }
  add_background(view, scattered, image);
}

double SceneRenderer::electrons_of(const LightSample& light, const Vector2& pixel) const {
  return light.photons_per_m2_s * settings_.electrons_per_photon_m2() * duration_s_ * projection_->vignetting(pixel);
}

void SceneRenderer::add_stars(const View& view, PhotonImage& image) {
  const Exposure& exposure = view.exposure;
  const Vector3 axis_eci = view.R_camera_eci.transpose() * region_cone_.axis;
  const double turned = exposure.rate_camera.norm() * duration_s_;
  stars_.clear();
  sky_.find(axis_eci, std::min(region_cone_.half_angle + 0.5 * turned, M_PI), exposure.years_since_j2000,
            exposure.earth_velocity_bcrs + exposure.camera_velocity_eci, stars_);
  for (const ApparentStar& star : stars_) {
    const Vector3 direction = view.R_camera_eci * star.direction_eci;
    const auto pixel = projection_->project(direction);
    if (!pixel) continue;
    if (angle_between(star.direction_eci, view.moon) < view.moon_radius) continue;
    const double passed = view.earth_in_field ? view.passed_by_earth(star.direction_eci) : 1.0;
    if (passed == 0.0) continue;
    const Vector2 smear_px =
        duration_s_ * projection_->image_velocity(direction, direction.cross(exposure.rate_camera));
    spread_.add(ImagePoint{*pixel, passed * electrons_of({direction, star.star->photons_per_m2_s}, *pixel)}, smear_px,
                image);
  }
}

bool SceneRenderer::is_in_view(const View& view, const ObjectInView& object) const {
  const double distance = object.position_eci.norm();
  if (!(distance > 0.0)) return false;
  const Vector3 direction_eci = object.position_eci / distance;
  const Vector3 direction = view.R_camera_eci * direction_eci;
  const double radius = std::asin(std::min(1.0, kLargestObject / distance));
  if (angle_between(direction, region_cone_.axis) > region_cone_.half_angle + radius) return false;
  return !view.earth.hides(direction_eci, distance);
}

bool SceneRenderer::hides(const View& view, const ObjectInView& object) const {
  constexpr double kHides_m = 0.01;  // a pixel
  return covers_ && object.position_eci.norm() * view.pixel_rad < kHides_m && is_in_view(view, object);
}

void SceneRenderer::hide_behind(const View& view, const ObjectInView& object, PhotonImage& image) {
  constexpr float kNoticed = 0.5F;  // electrons
  const bool is_noticed = std::ranges::any_of(image.electrons, [](float electrons) { return electrons > kNoticed; });
  if (!is_noticed || !hides(view, object)) return;
  covers_(view_of(view, object), *projection_, image.region, covered_);
  for (std::size_t k = 0; k < covered_.size(); ++k) image.electrons[k] *= 1.0F - covered_[k];
}

ObjectView SceneRenderer::view_of(const View& view, const ObjectInView& object) const {
  const double distance = object.position_eci.norm();
  const Vector3 direction = view.R_camera_eci * (object.position_eci / distance);
  ObjectView asked;
  asked.model = object.model;
  asked.position_camera = distance * direction;
  asked.R_camera_body = view.R_camera_eci * object.q_body_eci.normalized().toRotationMatrix().transpose();
  asked.sun_direction_camera = (view.R_camera_eci * view.sun).normalized();
  asked.sun_photons_per_m2_s = object.sunlit * view.sun_photons;
  const Vector3 earth_light = view.R_camera_eci * view.earth.light_eci(view.sun_photons);
  asked.earth_photons_per_m2_s = earth_light.norm();
  if (asked.earth_photons_per_m2_s > 0.0) asked.earth_direction_camera = earth_light.normalized();
  asked.earth_half_angle = view.earth.angular_radius();
  asked.pixel_rad = view.pixel_rad;
  return asked;
}

void SceneRenderer::add_object(const View& view, const ObjectInView& object, PhotonImage& image) {
  if (!is_in_view(view, object)) return;
  const double distance = object.position_eci.norm();
  const Vector3 direction_eci = object.position_eci / distance;
  const Vector3 direction = view.R_camera_eci * direction_eci;
  samples_.clear();
  objects_(view_of(view, object), samples_);

  points_.clear();
  for (const LightSample& sample : samples_)
    if (const auto pixel = projection_->project(sample.direction_camera))
      points_.push_back({*pixel, electrons_of(sample, *pixel)});
  // Motion across the line of sight rotates the direction; the rotation of the camera adds to it.
  const Vector3 across = object.velocity_eci - direction_eci * direction_eci.dot(object.velocity_eci);
  const Vector3 direction_rate = view.R_camera_eci * across / distance + direction.cross(view.exposure.rate_camera);
  spread_.add(points_, duration_s_ * projection_->image_velocity(direction, direction_rate), image);
}

/// Their electrons on the detector.
double SceneRenderer::add_sun_and_moon(const View& view, PhotonImage& image) {
  const Exposure& exposure = view.exposure;
  const auto across_of = [&](double radius) { return static_cast<int>(4.0 * radius / view.pixel_rad) + 2; };
  const auto in_field = [&](const Vector3& direction_eci) {
    constexpr double kHalfDegree = 0.5 * kDegree;  // more than their radii
    return angle_between(view.R_camera_eci * direction_eci, detector_cone_.axis) <
           detector_cone_.half_angle + kHalfDegree;
  };
  double electrons = 0.0;
  if (in_field(view.sun)) {
    const double radius = std::asin(truth::kSunRadius / view.sun.norm());
    samples_.clear();
    uniform_disc(view.sun.normalized(), radius, view.sun_photons, across_of(radius), samples_);
    electrons += add_disc(view, exposure.earth_velocity_bcrs + exposure.camera_velocity_eci, image);
  }
  if (in_field(view.moon)) {
    samples_.clear();
    moon_disc(view.moon, (view.sun - view.moon).normalized(), settings_.zero_magnitude_photons,
              across_of(kMoonRadiusM / view.moon.norm()), samples_);
    electrons += add_disc(view, exposure.camera_velocity_eci, image);  // it orbits the Sun with the Earth
  }
  return electrons;
}

/// The samples, their directions in ECI axes before aberration by `velocity`. Electrons on the detector.
double SceneRenderer::add_disc(const View& view, const Vector3& velocity, PhotonImage& image) {
  double electrons = 0.0;
  Vector3 middle = Vector3::Zero();
  points_.clear();
  for (const LightSample& sample : samples_) {
    const double passed = view.passed_by_earth(sample.direction_camera);
    const Vector3 direction = view.R_camera_eci * apparent_direction(sample.direction_camera, velocity);
    const auto pixel = projection_->project(direction);
    if (!pixel || passed == 0.0) continue;
    points_.push_back({*pixel, passed * electrons_of(sample, *pixel)});
    middle += direction;
    if (is_on(settings_.detector, *pixel)) electrons += points_.back().electrons;
  }
  if (points_.empty()) return 0.0;
  middle.normalize();
  const Vector2 velocity_px = projection_->image_velocity(middle, middle.cross(view.exposure.rate_camera));
  spread_.add(points_, duration_s_ * velocity_px, image);
  return electrons;
}

/// Covers what lies behind and adds its light; electrons on the detector.
double SceneRenderer::add_earth(const View& view, PhotonImage& image) {
  const double from_surface = EarthDisc::radiance(view.sun_photons) * settings_.electrons_per_photon_m2() *
                              duration_s_ * view.pixel_rad * view.pixel_rad;
  const auto electrons_at = [&](const Vector2& pixel, const Vector3& direction) {
    const EarthSight sight = view.earth.look(view.R_camera_eci.transpose() * direction, view.pixel_rad);
    if (sight.covered == 0.0 || sight.cosine_of_sun <= 0.0) return 0.0;
    const double pixel_solid_angle = direction.z() * direction.z() * direction.z();  // against that on the boresight
    return sight.covered * sight.cosine_of_sun * from_surface * pixel_solid_angle * projection_->vignetting(pixel);
  };
  const Region& region = image.region;
  const Vector3 centre = view.R_camera_eci * view.earth.centre_direction_eci();
  if (angle_between(centre, region_cone_.axis) < view.earth.angular_radius() + region_cone_.half_angle) {
    region_directions_.prepare(region);
    for (int y = region.y; y < region.y + region.height; ++y)
      for (int x = region.x; x < region.x + region.width; ++x)
        image.at(x, y) += static_cast<float>(electrons_at(Vector2(x, y), region_directions_.at(x, y)));
  }

  constexpr int kAcross = 24, kDown = 15;  // sampling the whole detector
  double sum = 0.0;
  const DetectorSettings& detector = settings_.detector;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const Vector2 pixel((i + 0.5) * detector.width / kAcross, (j + 0.5) * detector.height / kDown);
      sum += electrons_at(pixel, projection_->direction_of(pixel));
    }
  return sum * detector.width * detector.height / (kAcross * kDown);
}

/// Fraction of the Sun's disc that the Earth does not hide, 0 to 1.
double SceneRenderer::sun_in_sight(const View& view) {
  samples_.clear();
  uniform_disc(view.sun.normalized(), std::asin(truth::kSunRadius / view.sun.norm()), 1.0, 12, samples_);
  double in_sight = 0.0;
  for (const LightSample& sample : samples_)
    in_sight += sample.photons_per_m2_s * view.passed_by_earth(sample.direction_camera);
  return in_sight;
}

/// Uniform veiling glare, and the Sun on the baffle: full where the Sun is at the field's edge or within, falling with
/// the square to nothing at the exclusion angle, half as much again on the Sun's side of the detector as in its middle.
void SceneRenderer::add_background(const View& view, double scattered, PhotonImage& image) {
  const DetectorSettings& detector = settings_.detector;
  const double even = kVeilingGlare * scattered / (static_cast<double>(detector.width) * detector.height);
  const Vector3 sun = (view.R_camera_eci * view.sun).normalized();
  const double off_axis = angle_between(sun, Vector3::UnitZ());
  const double edge = detector_cone_.half_angle;
  const double exclusion = std::max(settings_.optics.sun_exclusion_deg * kDegree, edge + 1e-6);
  const double closeness = std::clamp((exclusion - off_axis) / (exclusion - edge), 0.0, 1.0);
  double stray = 0.0;
  if (closeness > 0.0)
    stray = settings_.optics.stray_light_electrons * duration_s_ * closeness * closeness * sun_in_sight(view);
  if (even == 0.0 && stray == 0.0) return;

  const double half_diagonal = 0.5 * std::hypot(detector.width, detector.height);
  const double side = sun.head<2>().norm();
  const Vector2 to_sun = side > 1e-3 ? Vector2(sun.head<2>() / side) : Vector2(Vector2::Zero());
  const Vector2 slope = 0.5 * stray / half_diagonal * to_sun;  // electrons a pixel
  const Vector2 middle(0.5 * (detector.width - 1), 0.5 * (detector.height - 1));
  const Region& region = image.region;
  for (int y = region.y; y < region.y + region.height; ++y)
    for (int x = region.x; x < region.x + region.width; ++x)
      image.at(x, y) += static_cast<float>(even + stray + slope.dot(Vector2(x, y) - middle));
}

}  // namespace vbar::twins::camera
