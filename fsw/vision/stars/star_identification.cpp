#include "fsw/vision/stars/star_identification.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "fsw/math/math.h"

namespace vbar::fsw::stars {

namespace {

constexpr double kArcsecond = math::kPi / 648000.0;
constexpr double kVaguest = 15.0 * kArcsecond;   // objects less precise are not used in patterns
constexpr double kPairGate = 3.0;                // sigma of a distance
constexpr double kPairSlack = 4.5 * kArcsecond;  // aberration differs by up to 4 arcsec between two stars, doubles
constexpr double kPlaceGate = 3.5;               // sigma of a third object's position
constexpr double kSuppositionSigma = 15.0 * kArcsecond;
constexpr int kNeeded = 2;    // number of other objects with a star at their position for a hypothesis to be verified
constexpr int kPatience = 8;  // objects without a star, and none with one, until it is rejected
constexpr MagnitudeGate kGate{};

/// Axes of a pair: towards its middle, from the first to the second, and across both.
Matrix3 pair_axes(const Vector3& first, const Vector3& second) {
  Matrix3 axes;
  axes.col(0) = (first + second).normalized();
  axes.col(1) = (second - first).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

int chord_step(double chord) {
  const int step = static_cast<int>(chord / kChordStep) - kFirstChord;
  return step < 0 ? 0 : step > kChordSteps ? kChordSteps : step;
}

}  // namespace

Status check_objects(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci) {
  if (objects.size() > imaging::kMaxObjects) return Status::kTooLong;
  double sum = velocity_over_c_eci.sum() + field.centre_camera.sum() + field.radius_rad;
  bool positive = field.radius_rad > 0.0;
  for (const ObservedStar& object : objects) {
    sum += object.direction_camera.sum() + object.sigma_rad + object.magnitude;
    positive = positive && object.sigma_rad > 0.0;
  }
  if (!math::is_finite(sum)) return Status::kNotFinite;
  return positive ? Status::kOk : Status::kInvalidArgument;
}

std::size_t StarIdentifier::sort_pattern_objects(std::span<const ObservedStar> objects) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (objects[k].sigma_rad <= kVaguest) order_[count++] = k;
  }
  std::sort(order_.data(), order_.data() + count, [&](std::size_t a, std::size_t b) {
    return objects[a].magnitude != objects[b].magnitude ? objects[a].magnitude < objects[b].magnitude : a < b;
  });
  return count < kMaxPatternObjects ? count : kMaxPatternObjects;
}

void StarIdentifier::make_pattern(std::span<const ObservedStar> objects, std::size_t count, std::size_t i,
                                  std::size_t j) {
  const ObservedStar& first = objects[order_[i]];
  const ObservedStar& second = objects[order_[j]];
  pattern_.R_camera_pattern = pair_axes(first.direction_camera, second.direction_camera);
  const double half_chord = 0.5 * (second.direction_camera - first.direction_camera).norm();
  const double pair_variance = first.sigma_rad * first.sigma_rad + second.sigma_rad * second.sigma_rad;
  pattern_.others = 0;
  for (std::size_t k = 0; k < count; ++k) {
    // The order of brightness is used from both ends: bright objects may all be false, and so may faint ones.
    const std::size_t place = k % 2 == 0 ? k / 2 : count - 1 - k / 2;
    if (place == i || place == j) continue;
    const ObservedStar& other = objects[order_[place]];
    const Vector3 direction = pattern_.R_camera_pattern.transpose() * other.direction_camera;
    // The pair's own error moves its middle and rotates it: the effect grows with the distance from the middle.
    const double arm = math::hypot(direction.y(), direction.z()) / half_chord;
    const double variance = other.sigma_rad * other.sigma_rad + 0.25 * pair_variance * (1.0 + arm * arm);
    const double tolerance = kPlaceGate * math::sqrt(variance) + kPairSlack;
    pattern_.object[pattern_.others] = order_[place];
    pattern_.direction[pattern_.others] = direction;
    pattern_.tolerance[pattern_.others++] = tolerance < kCellMargin ? tolerance : kCellMargin;
  }
}

Status StarIdentifier::try_hypothesis(std::span<const ObservedStar> objects, const Field& field,
                                      const Vector3& velocity_over_c_eci, const Vector3& first_eci,
                                      const Vector3& second_eci) {
  ++hypotheses_;
  const Matrix3 R_eci_pattern = pair_axes(first_eci, second_eci);
  int agreements = 0;
  for (std::size_t k = 0; k < pattern_.others && agreements < kNeeded; ++k) {
    if (agreements == 0 && k >= kPatience) return Status::kDidNotConverge;
    const Vector3 apparent = R_eci_pattern * pattern_.direction[k];
    // Nine of ten hypotheses end here. The length of the direction does not matter yet.
    if (!is_occupied(apparent - velocity_over_c_eci)) continue;
    const Vector3 place = without_aberration(apparent, velocity_over_c_eci);
    const double magnitude = objects[pattern_.object[k]].magnitude;
    if (nearest_star(place, pattern_.tolerance[k], magnitude, kGate).star >= 0) ++agreements;
  }
  if (agreements < kNeeded) return Status::kDidNotConverge;
  const AttitudeHypothesis supposed{.R_camera_eci = pattern_.R_camera_pattern * R_eci_pattern.transpose(),
                                    .sigma_rad = kSuppositionSigma,
                                    .agreements_spent = 2,
                                    .hypotheses = hypotheses_};
  return verification_.verify(objects, field, velocity_over_c_eci, supposed, trial_);
}

Status StarIdentifier::try_pair(std::span<const ObservedStar> objects, const Field& field,
                                const Vector3& velocity_over_c_eci, std::size_t i, std::size_t j) {
  const ObservedStar& a = objects[order_[i]];
  const ObservedStar& b = objects[order_[j]];
  const double chord = (a.direction_camera - b.direction_camera).norm();
  const double slack = kPairGate * math::sqrt(a.sigma_rad * a.sigma_rad + b.sigma_rad * b.sigma_rad) + kPairSlack;
  const auto begin = static_cast<std::size_t>(chord_step(chord - slack));
  const auto end = static_cast<std::size_t>(chord_step(chord + slack + kChordStep));
  const std::uint32_t first = vbar_star_tables.first_of_chord[begin];
  const std::uint32_t last = vbar_star_tables.first_of_chord[end];
  for (std::uint32_t k = first; k < last; ++k) {
    const int bright = vbar_star_tables.pair[k][0];
    const int faint = vbar_star_tables.pair[k][1];
    const bool straight =
        kGate.admits(a.magnitude, star_magnitude(bright)) && kGate.admits(b.magnitude, star_magnitude(faint));
    const bool crossed =
        kGate.admits(b.magnitude, star_magnitude(bright)) && kGate.admits(a.magnitude, star_magnitude(faint));
    if (!straight && !crossed) continue;
    const Vector3 bright_eci = with_aberration(star_direction_eci(bright), velocity_over_c_eci);
    const Vector3 faint_eci = with_aberration(star_direction_eci(faint), velocity_over_c_eci);
    if (straight && try_hypothesis(objects, field, velocity_over_c_eci, bright_eci, faint_eci) == Status::kOk) {
      return Status::kOk;
    }
    if (crossed && try_hypothesis(objects, field, velocity_over_c_eci, faint_eci, bright_eci) == Status::kOk) {
      return Status::kOk;
    }
    if (hypotheses_ >= kMaxHypotheses) return Status::kDidNotConverge;
  }
  return Status::kDidNotConverge;
}

Status StarIdentifier::lost_in_space(std::span<const ObservedStar> objects, const Field& field,
                                     const Vector3& velocity_over_c_eci) {
  const Status status = check_objects(objects, field, velocity_over_c_eci);
  if (status != Status::kOk) return status;
  const std::size_t count = sort_pattern_objects(objects);
  hypotheses_ = 0;
  // In order of the sum of their brightness ranks: no single false object is in all early pairs.
  for (std::size_t sum = 1; sum + 2 < 2 * count; ++sum) {
    for (std::size_t i = sum < count ? 0 : sum - count + 1; 2 * i < sum; ++i) {
      const std::size_t j = sum - i;
      const double chord =
          (objects[order_[i]].direction_camera - objects[order_[j]].direction_camera).norm() / kChordStep;
      if (chord < kFirstChord || chord > kLastChord) continue;
      make_pattern(objects, count, i, j);
      if (try_pair(objects, field, velocity_over_c_eci, i, j) == Status::kOk) {
        fix_ = trial_;
        return Status::kOk;
      }
      if (hypotheses_ >= kMaxHypotheses) return Status::kDidNotConverge;
    }
  }
  return Status::kDidNotConverge;
}

namespace {

constexpr double kVoteSigma = 6.0 * kArcsecond;
constexpr double kWidestVote = 120.0 * kArcsecond;

}  // namespace

std::size_t StarIdentifier::cast_votes(std::span<const ObservedStar> objects, const Field& field,
                                       const Matrix3& R_camera_eci, double tolerance,
                                       const Vector3& velocity_over_c_eci) {
  const Vector3 axis = without_aberration(R_camera_eci.transpose() * field.centre_camera, velocity_over_c_eci);
  const Result<int> near = stars_in_cone(axis, field.radius_rad + 2.0 * tolerance, in_cone_);
  if (!near.ok()) return 0;
  // Length of the shift: two axes across the boresight, and the effect of roll at the edge of the field.
  const double reach = tolerance * 1.5;
  std::size_t votes = 0;
  for (int k = 0; k < near.value(); ++k) {
    const int star = in_cone_[static_cast<std::size_t>(k)];
    const Vector3 place = R_camera_eci * with_aberration(star_direction_eci(star), velocity_over_c_eci);
    const double magnitude = star_magnitude(star);
    for (std::size_t object = 0; object < objects.size(); ++object) {
      const Vector3 shift = objects[object].direction_camera - place;
      if (shift.squaredNorm() > reach * reach || !kGate.admits(objects[object].magnitude, magnitude)) continue;
      if (objects[object].sigma_rad > 0.5 * kCellMargin) continue;
      if (votes == kMaxVotes) return votes;
      vote_[votes++] = {static_cast<int>(object), star, shift.head<2>(), 0};
    }
  }
  return votes;
}

void StarIdentifier::count_support(std::size_t votes, double radius) {
  for (std::size_t a = 0; a < votes; ++a) {
    for (std::size_t b = 0; b < votes; ++b) {
      if ((vote_[a].shift - vote_[b].shift).squaredNorm() <= radius * radius) ++vote_[a].support;
    }
  }
}

Status StarIdentifier::try_seed(std::span<const ObservedStar> objects, const Field& field,
                                const Vector3& velocity_over_c_eci, std::size_t votes, const Vote& seed,
                                double radius) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < votes && count < seed_pair_.size(); ++k) {
    const Vote& vote = vote_[k];
    if ((vote.shift - seed.shift).squaredNorm() > radius * radius) continue;
    const ObservedStar& object = objects[static_cast<std::size_t>(vote.object)];
    seed_pair_[count++] = {object.direction_camera, with_aberration(star_direction_eci(vote.star), velocity_over_c_eci),
                           object.sigma_rad + kVoteSigma};
  }
  const Result<AttitudeEstimate> attitude = determine_attitude(std::span(seed_pair_).first(count));
  if (!attitude.ok()) return attitude.status();
  const AttitudeHypothesis supposed{.R_camera_eci = attitude.value().R_camera_eci,
                                    .sigma_rad = kSuppositionSigma,
                                    .agreements_spent = 1,
                                    .hypotheses = static_cast<int>(votes)};
  return verification_.verify(objects, field, velocity_over_c_eci, supposed, trial_);
}

Status StarIdentifier::track(std::span<const ObservedStar> objects, const Field& field,
                             const Matrix3& predicted_R_camera_eci, double tolerance_rad,
                             const Vector3& velocity_over_c_eci) {
  const Status status = check_objects(objects, field, velocity_over_c_eci);
  if (status != Status::kOk) return status;
  if (!math::is_finite(predicted_R_camera_eci.sum()) || !math::is_finite(tolerance_rad)) return Status::kNotFinite;
  if (!(tolerance_rad > 0.0)) return Status::kInvalidArgument;
  if (tolerance_rad > kLargestTolerance) return Status::kOutOfRange;

  const std::size_t votes = cast_votes(objects, field, predicted_R_camera_eci, tolerance_rad, velocity_over_c_eci);
  // Votes for one attitude differ by noise and, from edge to edge, by its roll.
  const double spread = 4.0 * kVoteSigma + tolerance_rad * field.radius_rad;
  const double radius = spread < kWidestVote ? spread : kWidestVote;
  count_support(votes, radius);
  for (int seed = 0; seed < kMaxSeeds; ++seed) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < votes; ++k) {
      if (vote_[k].support > vote_[best].support) best = k;
    }
    if (votes == 0 || vote_[best].support < 2) break;
    if (try_seed(objects, field, velocity_over_c_eci, votes, vote_[best], radius) == Status::kOk) {
      fix_ = trial_;
      return Status::kOk;
    }
    const Vector2 tried = vote_[best].shift;
    for (std::size_t k = 0; k < votes; ++k) {
      if ((vote_[k].shift - tried).squaredNorm() <= radius * radius) vote_[k].support = 0;
    }
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::stars
