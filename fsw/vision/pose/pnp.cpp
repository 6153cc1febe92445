#include "fsw/vision/pose/pnp.h"

#include <span>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/vision/pose/closed_form_pose.h"
#include "fsw/vision/pose/refinement.h"

namespace vbar::fsw::pose {
namespace {

constexpr std::size_t kMaxKeypoints = pose::kKeypoints;
constexpr std::size_t kMinimalSet = 4;
constexpr int kMaxSets = 64;
/// Enough sets are drawn when the probability that none of them was free of outliers is at most this.
constexpr double kMaxFailureProbability = 1e-4;
/// Factor on the inlier limits for poses of minimal sets, which depend on the noise of four keypoints.
constexpr double kLoose = 2.0;

/// The usable keypoints.
struct Problem {
  std::array<Observation, kMaxKeypoints> observations{};
  std::array<SeenPoint, kMaxKeypoints> points{};
  std::array<std::size_t, kMaxKeypoints> keypoint{};  ///< its index
  std::size_t count = 0;
};

/// Score of a pose: more inliers, then smaller cost.
struct Verdict {
  std::array<bool, kMaxKeypoints> is_inlier{};
  int inliers = 0;
  double cost = 0.0;  ///< whitened squares over their limit, at most 1 per keypoint

  [[nodiscard]] bool is_better_than(const Verdict& other) const {
    return inliers != other.inliers ? inliers > other.inliers : cost < other.cost;
  }
};

struct Evaluated {
  RefinedPose refined;
  Verdict verdict;
};

/// W with W C W' = I. False unless C is positive definite.
bool whiten(const Matrix2& covariance, Matrix2& whitening) {
  const math::Cholesky<2> cholesky(covariance);
  if (!cholesky.ok()) return false;
  whitening.col(0) = cholesky.solve_lower(Vector2::UnitX());
  whitening.col(1) = cholesky.solve_lower(Vector2::UnitY());
  return true;
}

Problem problem_of(const Keypoints& keypoints, const KeypointShape& shape, const imaging::CameraModel& camera) {
  Problem problem;
  double finest = 0.0;
  for (std::size_t k = 0; k < keypoints.size(); ++k) {
    if (!keypoints[k].is_usable) continue;
    Observation& observation = problem.observations[problem.count];
    if (!whiten(keypoints[k].covariance_px2, observation.whitening)) continue;
    const Result<Vector3> direction = imaging::direction_of(camera, keypoints[k].pixel);
    if (!direction.ok()) continue;
    observation.pixel = keypoints[k].pixel;
    observation.body = shape[k];
    SeenPoint& point = problem.points[problem.count];
    point.image = direction.value().head<2>() / direction.value().z();
    point.body = shape[k];
    point.weight = observation.whitening.squaredNorm();
    if (point.weight > finest) finest = point.weight;
    problem.keypoint[problem.count++] = k;
  }
  for (std::size_t k = 0; k < problem.count; ++k) problem.points[k].weight /= finest;
  return problem;
}

Verdict evaluate(const Problem& problem, const TargetPose& pose, const imaging::CameraModel& camera,
                 const PnpSettings& settings, double widening) {
  const double max_squares = widening * widening * settings.inlier_sigmas * settings.inlier_sigmas;
  const double floor_px = widening * settings.inlier_floor_px;
  Verdict verdict;
  for (std::size_t k = 0; k < problem.count; ++k) {
    const Observation& observation = problem.observations[k];
    const Result<Vector2> miss = miss_of(observation, pose, camera);
    double share = 1.0;
    if (miss.ok()) {
      const double squares = (observation.whitening * miss.value()).squaredNorm();
      verdict.is_inlier[k] = squares <= max_squares || miss.value().squaredNorm() <= floor_px * floor_px;
      if (squares < max_squares) share = squares / max_squares;
    }
    if (verdict.is_inlier[k]) ++verdict.inliers;
    verdict.cost += share;
  }
  return verdict;
}

Result<RefinedPose> refine_inliers(const Problem& problem, const Verdict& verdict, const imaging::CameraModel& camera,
                                   const TargetPose& start) {
  std::array<Observation, kMaxKeypoints> inliers{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < problem.count; ++k) {
    if (verdict.is_inlier[k]) inliers[count++] = problem.observations[k];
  }
  if (count < kMinimalSet) return Status::kNotReady;
  return refine_pose(std::span(inliers).first(count), camera, start);
}

/// Refined over its inliers by wide limits, then twice over those by the nominal ones.
Result<Evaluated> polish(const Problem& problem, const TargetPose& start, const imaging::CameraModel& camera,
                         const PnpSettings& settings) {
  Evaluated evaluated;
  evaluated.refined.pose = start;
  for (const double widening : {kLoose, 1.0, 1.0}) {
    evaluated.verdict = evaluate(problem, evaluated.refined.pose, camera, settings, widening);
    const Result<RefinedPose> refined = refine_inliers(problem, evaluated.verdict, camera, evaluated.refined.pose);
    if (!refined.ok()) return refined.status();
    evaluated.refined = refined.value();
  }
  return evaluated;
}

/// Closed form's pose of these points with the largest consensus.
struct Guess {
  TargetPose pose;
  Verdict verdict;
  bool is_there = false;
};
void guess_from(std::span<const SeenPoint> points, const Problem& problem, const imaging::CameraModel& camera,
                const PnpSettings& settings, Guess& best) {
  const ClosedFormPoses poses = closed_form_poses(points);
  for (std::size_t k = 0; k < poses.count; ++k) {
    const Verdict verdict = evaluate(problem, poses.poses[k], camera, settings, kLoose);
    if (best.is_there && !verdict.is_better_than(best.verdict)) continue;
    best = {poses.poses[k], verdict, true};
  }
}

/// Random numbers: a count through an integer hash (Wellons 2018, lowbias32).
class Draws {
 public:
  explicit Draws(std::uint32_t seed) : seed_(mix(seed)) {}

  /// 0 to n - 1.
  std::size_t below(std::size_t n) { return mix(seed_ ^ count_++) % static_cast<std::uint32_t>(n); }

 private:
  static std::uint32_t mix(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    return x ^ (x >> 16);
  }
  std::uint32_t seed_;
  std::uint32_t count_ = 1;
};

/// Probability that none of `sets` sets consists of inliers alone, given the share of inliers.
double failure_probability(int sets, int inliers, std::size_t keypoints) {
  double chance = 1.0;
  for (std::size_t k = 0; k < kMinimalSet; ++k) {
    chance *= (inliers - static_cast<double>(k)) / static_cast<double>(keypoints - k);
  }
  double probability = 1.0;
  for (int k = 0; k < sets; ++k) probability *= 1.0 - chance;
  return probability;
}

Guess guess_by_sets(const Problem& problem, const imaging::CameraModel& camera, const PnpSettings& settings,
                    std::uint32_t seed) {
  Draws draws(seed);
  Guess best;
  for (int set = 0; set < kMaxSets; ++set) {
    std::array<SeenPoint, kMaxKeypoints> points = problem.points;
    for (std::size_t k = 0; k < kMinimalSet; ++k) {
      const std::size_t other = k + draws.below(problem.count - k);
      const SeenPoint drawn = points[other];
      points[other] = points[k];
      points[k] = drawn;
    }
    guess_from(std::span(points).first(kMinimalSet), problem, camera, settings, best);
    if (best.is_there && failure_probability(set + 1, best.verdict.inliers, problem.count) < kMaxFailureProbability)
      break;
  }
  return best;
}

/// The closed form of all points that agree is used as initial value as well: it may find a lower minimum.
void polish_further(const Problem& problem, const imaging::CameraModel& camera, const PnpSettings& settings,
                    Evaluated& best) {
  std::array<SeenPoint, kMaxKeypoints> points{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < problem.count; ++k) {
    if (best.verdict.is_inlier[k]) points[count++] = problem.points[k];
  }
  const ClosedFormPoses poses = closed_form_poses(std::span(points).first(count));
  for (std::size_t k = 0; k < poses.count; ++k) {
    const Result<Evaluated> other = polish(problem, poses.poses[k], camera, settings);
    if (!other.ok()) continue;
    const Verdict& verdict = other.value().verdict;
    const bool is_lower = verdict.inliers == best.verdict.inliers && other.value().refined.cost < best.refined.cost;
    if (verdict.inliers > best.verdict.inliers || is_lower) best = other.value();
  }
}

Result<PnpSolution> solution_of(const Problem& problem, const Evaluated& evaluated, const imaging::CameraModel& camera,
                                const PnpSettings& settings) {
  PnpSolution solution;
  solution.pose = evaluated.refined.pose;
  const double range = math::sqrt(solution.pose.position_camera_m.squaredNorm());
  if (!(range >= settings.nearest_m && range <= settings.farthest_m)) return Status::kOutOfRange;
  double squares = 0.0;
  for (std::size_t k = 0; k < problem.count; ++k) {
    if (!evaluated.verdict.is_inlier[k]) continue;
    const Result<Vector2> miss = miss_of(problem.observations[k], solution.pose, camera);
    if (!miss.ok()) return miss.status();
    squares += (problem.observations[k].whitening * miss.value()).squaredNorm();
    solution.is_inlier[problem.keypoint[k]] = true;
    ++solution.inliers;
  }
  solution.mean_square = squares / (2 * solution.inliers - 6);
  if (!(solution.mean_square <= settings.max_mean_square)) return Status::kDidNotConverge;
  const math::Cholesky6 cholesky(evaluated.refined.information);
  if (!cholesky.ok()) return Status::kDidNotConverge;
  solution.covariance = cholesky.inverse();
  return solution;
}

}  // namespace

Result<PnpSolution> solve_pnp(const Keypoints& keypoints, const KeypointShape& shape,
                              const imaging::CameraModel& camera, const PnpSettings& settings, std::uint32_t seed) {
  const Problem problem = problem_of(keypoints, shape, camera);
  const int minimum =
      settings.min_inliers > static_cast<int>(kMinimalSet) ? settings.min_inliers : static_cast<int>(kMinimalSet);
  if (static_cast<int>(problem.count) < minimum) return Status::kNotReady;

  // Usually all keypoints agree, and no set is drawn.
  Guess guess;
  guess_from(std::span(problem.points).first(problem.count), problem, camera, settings, guess);
  Result<Evaluated> best = guess.is_there ? polish(problem, guess.pose, camera, settings) : Status::kDidNotConverge;
  if (!best.ok() || best.value().verdict.inliers < static_cast<int>(problem.count)) {
    const Guess drawn = guess_by_sets(problem, camera, settings, seed);
    if (drawn.is_there) {
      const Result<Evaluated> other = polish(problem, drawn.pose, camera, settings);
      if (other.ok() && (!best.ok() || other.value().verdict.is_better_than(best.value().verdict))) best = other;
    }
  }
  if (!best.ok() || best.value().verdict.inliers < minimum) return Status::kDidNotConverge;
  Evaluated evaluated = best.value();
  polish_further(problem, camera, settings, evaluated);
  return solution_of(problem, evaluated, camera, settings);
}

}  // namespace vbar::fsw::pose
