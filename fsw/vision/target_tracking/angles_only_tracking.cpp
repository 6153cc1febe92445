#include "fsw/vision/target_tracking/angles_only_tracking.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/rtn.h"
#include "fsw/vision/stars/catalogue.h"

namespace vbar::fsw::target_tracking {
namespace {

// Magnitudes of a factor e of flux.
constexpr double kMagnitude = 1.0857362047581296;

constexpr double kMinFlux_dn = 1.0;

// Apparent radius from which on errors of single pixels and the point-spread function do not matter to an extent.
constexpr double kResolved_px = 1.5;

/// The cone about the centre of an image that includes its corners.
stars::Field field_of(const CameraSettings& settings) {
  const imaging::ImageFrame& frame = settings.frame;
  const auto direction = [&](double x, double y) {
    const auto result = imaging::direction_of(settings.model, Vector2(frame.origin_x + x, frame.origin_y + y));
    return result.ok() ? result.value() : Vector3(Vector3::UnitZ());
  };
  const double right = frame.width - 0.5;
  const double bottom = frame.height - 0.5;
  stars::Field field;
  field.centre_camera = direction(0.5 * frame.width - 0.5, 0.5 * frame.height - 0.5);
  for (const double x : {-0.5, right}) {
    for (const double y : {-0.5, bottom}) {
      const Vector3 corner = direction(x, y);
      const double angle = math::atan2(field.centre_camera.cross(corner).norm(), field.centre_camera.dot(corner));
      if (angle > field.radius_rad) field.radius_rad = angle;
    }
  }
  return field;
}

constexpr int kKnownHotPixel = target_tracking::HotPixelSettings{}.sightings;

SightingStatus without_target(target_tracking::TrackerState state) {
  switch (state) {
    case target_tracking::TrackerState::kSearching:
      return SightingStatus::kSearching;
    case target_tracking::TrackerState::kAmbiguous:
      return SightingStatus::kAmbiguous;
    case target_tracking::TrackerState::kTracking:
    case target_tracking::TrackerState::kCoasting:
      break;
  }
  return SightingStatus::kNoTarget;
}

/// The broadening of a point's image by the point-spread function is not an apparent size.
double apparent_radius_px(const imaging::DetectedObject& object, double point_spread_sigma_px) {
  const double excess = object.radius_px * object.radius_px - point_spread_sigma_px * point_spread_sigma_px;
  return excess > 0.0 ? math::sqrt(excess) : 0.0;
}

}  // namespace

void AnglesOnlyTracking::configure(const CameraSettings& settings) {
  settings_ = settings;
  field_ = field_of(settings);
  target_tracking::TrackerSettings tracker;
  const double per_px = 1.0 / settings.model.focal_length_px.x();
  tracker.resolved_rad = kResolved_px * per_px;
  tracker.field_sr = settings.frame.width * settings.frame.height * per_px * per_px;
  tracker_ = target_tracking::TargetTracker(tracker);
  sighting_ = {};
}

const Sighting& AnglesOnlyTracking::process(const TakenImage& image, const ImagePriors& priors) {
  sighting_ = {};
  sighting_.time = image.time;
  sighting_.image = image.number;
  sighting_.tiles_missing = image.tiles_missing;
  count_ = 0;
  sighting_.status = look(image, priors);
  return sighting_;
}

SightingStatus AnglesOnlyTracking::look(const TakenImage& image, const ImagePriors& priors) {
  if (const SightingStatus found = find_objects(image.view); found != SightingStatus::kBearing) return found;
  if (!priors.is_orbit_known) return SightingStatus::kNoOrbit;
  if (!identify_stars(priors)) return SightingStatus::kNoStars;
  return find_target(image, priors);
}

/// kBearing: no reason for rejection so far.
SightingStatus AnglesOnlyTracking::find_objects(const imaging::ImageView& image) {
  if (!(image.frame == settings_.frame)) return SightingStatus::kWrongFrame;
  const imaging::DetectionReport report = detector_.detect(image, settings_.detector);
  sighting_.background_dn = report.background_dn;
  sighting_.noise_dn = report.noise_dn;
  switch (report.condition) {
    case imaging::ImageCondition::kGood:
      break;
    case imaging::ImageCondition::kTooLittle:
      return SightingStatus::kTooLittle;
    case imaging::ImageCondition::kInvalid:
      return SightingStatus::kWrongFrame;
    case imaging::ImageCondition::kBlank:
    case imaging::ImageCondition::kSaturated:
      return SightingStatus::kBlank;
  }
  const auto objects = detector_.objects();
  sighting_.objects = static_cast<int>(objects.size());
  for (const imaging::DetectedObject& object : objects) {
    stars::ObservedStar& seen = seen_[count_++];
    const Result<Vector3> direction = imaging::direction_of(settings_.model, object.centroid_px);
    // Directions are undefined outside the domain of the lens model; that of the boresight matches no star to a pixel.
    seen.direction_camera = direction.ok() ? direction.value() : Vector3(Vector3::UnitZ());
    seen.sigma_rad = sigma_of(object);
    // Beside a bright neighbour the window of a faint object may contain less light than the background.
    const double flux_dn = object.flux_dn > kMinFlux_dn ? object.flux_dn : kMinFlux_dn;
    seen.magnitude = -kMagnitude * math::log(flux_dn / settings_.zero_magnitude_dn);
  }
  return SightingStatus::kBearing;
}

double AnglesOnlyTracking::sigma_of(const imaging::DetectedObject& object) const {
  return math::hypot(object.sigma_px, settings_.centroid_floor_px) / settings_.model.focal_length_px.x();
}

bool AnglesOnlyTracking::identify_stars(const ImagePriors& priors) {
  const auto seen = std::span(seen_).first(count_);
  const Vector3& velocity = priors.velocity_over_c_eci;
  Status status = Status::kNotReady;
  if (priors.R_camera_eci) {
    status = identifier_.track(seen, field_, *priors.R_camera_eci, settings_.pointing_tolerance, velocity);
    if (status == Status::kOk) sighting_.star_method = StarMethod::kPredicted;
  }
  if (status != Status::kOk) {
    status = identifier_.lost_in_space(seen, field_, velocity);
    if (status == Status::kOk) sighting_.star_method = StarMethod::kLostInSpace;
  }
  if (status != Status::kOk) return false;
  mark_stars(identifier_.fix());
  return true;
}

void AnglesOnlyTracking::mark_stars(const stars::AttitudeFix& fix) {
  sighting_.R_camera_eci = fix.R_camera_eci;
  sighting_.attitude_sigma = fix.sigma_rad;
  sighting_.stars = fix.matches;
  for (int k = 0; k < fix.matches; ++k) {
    const stars::StarMatch& match = fix.match[static_cast<std::size_t>(k)];
    const auto object = static_cast<std::size_t>(match.object);
    sighting_.kind[object] = ObjectKind::kStar;
    sighting_.hipparcos[object] = stars::star_hipparcos(match.catalogue);
  }
}

std::size_t AnglesOnlyTracking::collect_candidates(const ImagePriors& priors) {
  const Matrix3 R_rtn_camera = orbit::R_rtn_eci(priors.servicer) * sighting_.R_camera_eci.transpose();
  const auto objects = detector_.objects();
  const double per_px = 1.0 / settings_.model.focal_length_px.x();
  std::size_t count = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    // The centroid of a partly visible object is not observable.
    if (sighting_.kind[k] == ObjectKind::kStar || objects[k].is_cut) continue;
    target_tracking::Candidate& candidate = candidates_[count];
    candidate.direction_rtn = R_rtn_camera * seen_[k].direction_camera;
    // The centroid of a resolved body varies within the body.
    const double size = apparent_radius_px(objects[k], settings_.detector.point_spread_sigma_px) * per_px;
    candidate.sigma = math::hypot(math::hypot(seen_[k].sigma_rad, sighting_.attitude_sigma), size);
    candidate.apparent_radius = size;
    candidate.object = objects[k];
    object_of_candidate_[count++] = k;
  }
  return count;
}

SightingStatus AnglesOnlyTracking::find_target(const TakenImage& image, const ImagePriors& priors) {
  const std::size_t candidates = collect_candidates(priors);
  target_tracking::TrackerInput input;
  input.time = image.time;
  input.servicer = priors.servicer;
  input.candidates = std::span(candidates_).first(candidates);
  input.burns = priors.burns;
  input.prediction = priors.target;
  input.kept = priors.kept;
  input.is_search = priors.is_search;
  input.detection_probability = priors.detection_probability;
  const Result<target_tracking::TrackerOutput> tracked = tracker_.step(input);
  if (!tracked.ok()) return SightingStatus::kNoTarget;
  sighting_.hypotheses = tracked.value().hypotheses;
  sighting_.is_as_kept = tracked.value().is_as_kept;
  const auto objects = detector_.objects();
  for (std::size_t k = 0; k < candidates; ++k) {
    const std::size_t object = object_of_candidate_[k];
    if (tracker_.hot_pixels().sightings_of(objects[object]) >= kKnownHotPixel)
      sighting_.kind[object] = ObjectKind::kHotPixel;
  }
  if (tracked.value().candidate < 0) return without_target(tracked.value().state);
  const std::size_t object = object_of_candidate_[static_cast<std::size_t>(tracked.value().candidate)];
  sighting_.target = static_cast<int>(object);
  sighting_.kind[object] = ObjectKind::kTarget;
  measure_bearing(object);
  return tracked.value().confirmed ? SightingStatus::kBearing : SightingStatus::kNotConfirmed;
}

void AnglesOnlyTracking::measure_bearing(std::size_t object) {
  const Matrix3 R_eci_camera = sighting_.R_camera_eci.transpose();
  target_tracking::BearingMeasurement& bearing = sighting_.bearing;
  bearing.time = sighting_.time;
  bearing.direction_eci = R_eci_camera * seen_[object].direction_camera;
  bearing.sigma = math::hypot(seen_[object].sigma_rad, sighting_.attitude_sigma);
  bearing.origin_eci = R_eci_camera * (settings_.R_camera_body * settings_.position_body_m);
  bearing.apparent_radius = apparent_radius_px(detector_.objects()[object], settings_.detector.point_spread_sigma_px) /
                            settings_.model.focal_length_px.x();
}

}  // namespace vbar::fsw::target_tracking
