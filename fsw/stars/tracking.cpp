#include "fsw/math/math.h"
#include "fsw/stars/star_identification.h"

namespace vbar::fsw::stars {
namespace {

constexpr double kArcsecond = math::kPi / 648000.0;
constexpr double kSuppositionSigma = 15.0 * kArcsecond;
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
  constexpr MagnitudeGate kGate;
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
  const Supposition supposed{.R_camera_eci = attitude.value().R_camera_eci,
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
