#include "fsw/vision/stars/verification.h"

#include <algorithm>

#include "fsw/math/math.h"

namespace vbar::fsw::stars {
namespace {

constexpr double kArcsecond = math::kPi / 648000.0;
constexpr double kGate = 4.0;                         // sigma; a true star is outside once in 3000
constexpr double kCatalogueSigma = 1.0 * kArcsecond;  // proper motion, doubles' centre of light
constexpr int kRounds = 4;

/// 1 sigma of the predicted position of an object, from the attitude's error and its own.
double placement_sigma(const ObservedStar& object, const Matrix3& covariance_camera) {
  // An upper bound of the larger axis: the trace of the covariance across the direction.
  const Vector3& b = object.direction_camera;
  const double attitude = covariance_camera.trace() - b.dot(covariance_camera * b);
  // A rotation about b does not change b; one about an axis across b moves it by its size.
  return math::sqrt(object.sigma_rad * object.sigma_rad + kCatalogueSigma * kCatalogueSigma + 0.5 * attitude);
}

}  // namespace

double log_chance_of(int count, double expected) {
  if (count <= 0 || count <= expected) return 0.0;
  const double minimum = 1e-30;
  const double mean = expected > minimum ? expected : minimum;
  return count - mean + count * math::log(mean / count);
}

void Verification::add_match(int object, const Neighbour& neighbour) {
  for (std::size_t k = 0; k < count_; ++k) {
    if (star_[k].star != neighbour.star) continue;
    if (neighbour.squared_distance < star_[k].squared_distance) {  // a star is one object: the closer
      object_[k] = object;
      star_[k] = neighbour;
    }
    return;
  }
  object_[count_] = object;
  star_[count_++] = neighbour;
}

void Verification::match(std::span<const ObservedStar> objects, const Vector3& velocity_over_c_eci,
                         const Matrix3& R_camera_eci, const Matrix3& covariance_camera, const MagnitudeGate& gate) {
  count_ = 0;
  tolerance_area_ = 0.0;
  const Matrix3 R_eci_camera = R_camera_eci.transpose();
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const double sigma = placement_sigma(objects[k], covariance_camera);
    const double tolerance = kGate * sigma < kCellMargin ? kGate * sigma : kCellMargin;
    if (objects[k].sigma_rad > 0.5 * kCellMargin) continue;  // too imprecise to separate stars
    tolerance_area_ += math::kPi * tolerance * tolerance;
    const Vector3 place = without_aberration(R_eci_camera * objects[k].direction_camera, velocity_over_c_eci);
    const Neighbour neighbour = nearest_star(place, tolerance, objects[k].magnitude, gate);
    if (neighbour.star >= 0) add_match(static_cast<int>(k), neighbour);
  }
}

double Verification::median_magnitude_offset(std::span<const ObservedStar> objects) {
  for (std::size_t k = 0; k < count_; ++k) {
    offset_[k] = objects[static_cast<std::size_t>(object_[k])].magnitude - star_magnitude(star_[k].star);
  }
  std::sort(offset_.data(), offset_.data() + count_);
  return offset_[count_ / 2];
}

double Verification::star_density(const Vector3& centre_eci, double radius) {
  const Result<int> found = stars_in_cone(centre_eci, radius, in_field_);
  const double solid_angle = math::kTwoPi * (1.0 - math::cos(radius));
  const double minimum = 1.0 / (4.0 * math::kPi);  // at least one
  if (!found.ok() || !(solid_angle > 0.0)) return catalogue_size() / (4.0 * math::kPi);
  return found.value() / solid_angle + minimum;
}

Status Verification::verify(std::span<const ObservedStar> objects, const Field& field,
                            const Vector3& velocity_over_c_eci, const AttitudeHypothesis& supposed, AttitudeFix& fix) {
  Matrix3 R_camera_eci = supposed.R_camera_eci;
  Matrix3 covariance = supposed.sigma_rad * supposed.sigma_rad * Matrix3::Identity();
  MagnitudeGate gate;
  RobustAttitude best;
  for (int round = 0; round < kRounds; ++round) {
    match(objects, velocity_over_c_eci, R_camera_eci, covariance, gate);
    if (count_ < kFewestMatches) return Status::kDidNotConverge;
    gate = {median_magnitude_offset(objects), 1.5};
    for (std::size_t k = 0; k < count_; ++k) {
      const ObservedStar& object = objects[static_cast<std::size_t>(object_[k])];
      const double sigma = math::sqrt(object.sigma_rad * object.sigma_rad + kCatalogueSigma * kCatalogueSigma);
      pair_[k] = {object.direction_camera, with_aberration(star_direction_eci(star_[k].star), velocity_over_c_eci),
                  sigma};
      tag_[k] = static_cast<int>(k);
    }
    const Result<RobustAttitude> found =
        determine_attitude_robustly(std::span(pair_).first(count_), std::span(tag_).first(count_));
    if (!found.ok()) return Status::kDidNotConverge;
    best = found.value();
    R_camera_eci = best.estimate.R_camera_eci;
    covariance = best.estimate.covariance_camera;
  }
  if (best.kept < kFewestMatches) return Status::kDidNotConverge;

  const Vector3 centre = R_camera_eci.transpose() * field.centre_camera;
  const double expected = tolerance_area_ * star_density(centre, field.radius_rad);
  fix.log_chance = log_chance_of(best.kept - supposed.agreements_spent, expected) + math::log(supposed.hypotheses);
  if (!(fix.log_chance < kLogAcceptedChance)) return Status::kDidNotConverge;
  fix.R_camera_eci = R_camera_eci;
  fix.covariance_camera = covariance;
  const double mean = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  fix.sigma_rad = math::sqrt(mean + math::hypot(half, covariance(0, 1)));
  fix.sigma_roll_rad = math::sqrt(covariance(2, 2));
  fix.chi_square = best.estimate.chi_square;
  fix.magnitude_offset = gate.offset;
  fix.hypotheses = supposed.hypotheses;
  fix.matches = best.kept;
  for (int k = 0; k < best.kept; ++k) {
    const auto index = static_cast<std::size_t>(tag_[static_cast<std::size_t>(k)]);
    fix.match[static_cast<std::size_t>(k)] = {object_[index], star_[index].star};
  }
  return Status::kOk;
}

}  // namespace vbar::fsw::stars
