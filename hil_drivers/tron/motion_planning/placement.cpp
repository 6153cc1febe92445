#include "hil_drivers/tron/motion_planning/placement.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron {

namespace {

constexpr double kSmallA5_rad = 6.0 * (std::numbers::pi / 180.0);
constexpr double kNearA1_m = 0.05;
/// Seconds at a limit or in a singularity; less in proportion at a distance.
constexpr double kPenalty_s = 1.0;

double shortage(double value, double wanted) {
  return wanted > 0.0 ? std::clamp(1.0 - value / wanted, 0.0, 1.0) : 0.0;
}

double penalty_of(const Arm& arm, const Joints& joints, double margin_rad) {
  double sum = shortage(std::abs(joints[4]), kSmallA5_rad) + shortage(arm.wrist_from_a1_m(joints), kNearA1_m);
  for (std::size_t k = 0; k < kJoints; ++k) {
    const double angle = joints[static_cast<Eigen::Index>(k)];
    const AxisLimits& axis = arm.design().axes[k];
    sum += shortage(std::min(angle - axis.lower, axis.upper - angle), margin_rad);
  }
  return kPenalty_s * sum;
}

}  // namespace

Candidates candidates(const Arm& arm, const Eigen::Isometry3d& T_base_flange, const Joints& from,
                      const CandidateRules& rules) {
  Candidates found;
  const Branches branches = arm.inverse(T_base_flange, from);
  const auto bears = [&](const Joints& joints) {
    return !rules.cable_turn_rad || std::abs(joints[3] + joints[5]) <= *rules.cable_turn_rad;
  };
  for (std::size_t k = 0; k < branches.count; ++k) {
    if (!branches.is_within_limits[k]) continue;
    std::optional<Joints> chosen = arm.nearest_turn(branches.joints[k], from);
    if (!bears(*chosen)) {
      chosen.reset();
      double nearest = 0.0;
      for (const Joints& turned : arm.turns(branches.joints[k])) {
        const double distance = (turned - from).lpNorm<Eigen::Infinity>();
        if (!bears(turned) || (chosen && distance >= nearest)) continue;
        chosen = turned;
        nearest = distance;
      }
    }
    if (!chosen) continue;
    found.all[found.count++] = {*chosen, penalty_of(arm, *chosen, rules.limit_margin_rad)};
  }
  return found;
}

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBeamMiddle_m = 0.25;  ///< the target stays this near to the middle of the beam
constexpr double kYaw_rad = 55.0 * kDegree, kPitch_rad = 38.0 * kDegree;
constexpr double kCarriage_m = 0.8;
/// Spread of trials near the last placement.
constexpr double kNear_m = 0.08, kNear_rad = 4.0 * kDegree, kNearCarriage_m = 0.15;
/// Spread of the trials near the best one so far, relative to the first spread.
constexpr double kRefinement = 0.4;
/// Camera to target and Sun closer to parallel than this: the turn about the line of sight is free.
constexpr double kFreeTurn_rad = 5.0 * kDegree;
/// Candidates whose paths are checked.
constexpr std::size_t kKept = 40;
/// Per trial, of the search.
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The right-handed triad of z and the part of `x_ref` square to it.
Matrix3 frame(const Vector3& z, const Vector3& x_ref) {
  Matrix3 R;
  R.col(2) = z.normalized();
  R.col(0) = (x_ref - R.col(2).dot(x_ref) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

bool is_usable(const Scene& scene, const Posture& from) {
  return scene.T_C_T.matrix().allFinite() && scene.sun_C.allFinite() && scene.T_C_T.translation().norm() > 0.0 &&
         std::abs(scene.sun_C.norm() - 1.0) < 1e-6 && from.camera_rad.allFinite() && from.target_rad.allFinite() &&
         std::isfinite(from.carriage_m) && std::isfinite(scene.sunlit);
}

/// Unit vector from the target to the camera.
Vector3 towards_camera(double yaw, double pitch) {
  return {-std::cos(pitch) * std::cos(yaw), -std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

}  // namespace

/// The six that are free.
struct PlacementSearch::Trial {
  Vector3 target_L = Vector3::Zero();
  double yaw = 0.0, pitch = 0.0;
  double carriage_ahead_m = 0.0;  ///< distance of the camera from the carriage along x
};

struct PlacementSearch::Search {
  const Scene& scene;
  const Posture& from;
  std::optional<double> lamp_rad;
  Matrix3 R_L_C_last;
  double phase_rad;   ///< between the directions from the target to the camera and to the Sun
  bool is_turn_free;  ///< about the line of sight
  bool is_sun_free;   ///< no sunlight: its direction does not matter
  std::vector<std::pair<Placement, Trial>> best{};  ///< by cost
  NoPlacement counts{};

  [[nodiscard]] double bound() const { return best.size() < kKept ? kInfinity : best.back().first.cost_s; }
  void keep(const Placement& placement, const Trial& trial) {
    const auto at =
        std::ranges::upper_bound(best, placement.cost_s, {}, [](const auto& one) { return one.first.cost_s; });
    best.insert(at, {placement, trial});
    if (best.size() > kKept) best.pop_back();
  }
};

PlacementSearch::PlacementSearch(const TestbedDesign& bench, const TestbedBodies& bodies, const PathPlanner& paths,
                                 std::vector<Vector3> points_body, const PlacementSettings& settings,
                                 EarthLightCost earth)
    : bench_(bench),
      bodies_(bodies),
      paths_(paths),
      points_body_(std::move(points_body)),
      settings_(settings),
      earth_(std::move(earth)) {}

void PlacementSearch::judge_pose(const Trial& trial, const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_T,
                                 double lamp_rad, double sun_error_rad, Search& search) const {
  const double carriage_m = T_L_C.translation().x() + trial.carriage_ahead_m;
  if (carriage_m < bench_.track.axis.lower || carriage_m > bench_.track.axis.upper) {
    ++search.counts.beyond_reach;
    return;
  }
  const ArmPair& arms = bodies_.arms();
  const CandidateRules camera_rules{bench_.motion.limit_margin_rad, bench_.motion.cable_turn_rad};
  const CandidateRules target_rules{bench_.motion.limit_margin_rad, std::nullopt};
  const Candidates of_camera =
      candidates(arms.camera_arm(), arms.camera_flange(T_L_C, carriage_m), search.from.camera_rad, camera_rules);
  if (of_camera.count == 0) {
    ++search.counts.beyond_reach;
    return;
  }
  const Candidates of_target =
      candidates(arms.target_arm(), arms.target_flange(T_L_T), search.from.target_rad, target_rules);
  if (of_target.count == 0) {
    ++search.counts.beyond_reach;
    return;
  }
  const TestbedAxisLimits& limits = paths_.limits();
  const ProgressLimits carriage = limits.of_carriage(search.from.carriage_m, carriage_m);
  const double lamp_s = search.lamp_rad ? std::abs(lamp_rad - *search.lamp_rad) / bench_.lamp.speed_rad_s : 0.0;
  const double earth_s = earth_ ? earth_(search.scene, T_L_C, T_L_T) : 0.0;
  // Judgement of each arm by itself, made when it is first asked for.
  struct Judged {
    ArmCapsules bodies;
    std::uint32_t hidden = 0, shaded = 0;
    bool is_known = false, is_free = false;
  };
  std::array<Judged, kBranches> camera_judged, target_judged;
  const OrientedBox hull = bodies_.hull_at(T_L_T);
  const Vector3 eye = T_L_C.translation();
  const std::vector<Vector3> points = bodies_.points_at(T_L_T, points_body_);
  const Vector3 towards_lamp = Lamp::direction(lamp_rad);
  const std::vector<Vector3> lit =
      search.is_sun_free ? std::vector<Vector3>() : TestbedBodies::lit_points(hull, towards_lamp);
  const auto of_camera_arm = [&](std::size_t k) -> const Judged& {
    Judged& judged = camera_judged[k];
    if (judged.is_known) return judged;
    judged.is_known = true;
    judged.bodies = bodies_.camera_arm_at(of_camera.all[k].joints_rad, carriage_m);
    judged.is_free = bodies_.is_camera_arm_free(judged.bodies);
    if (!judged.is_free) return judged;
    judged.hidden = TestbedBodies::hidden_by_camera_arm(judged.bodies, eye, points);
    judged.shaded = bodies_.shaded_by(judged.bodies, towards_lamp, lit);
    return judged;
  };
  const auto of_target_arm = [&](std::size_t k) -> const Judged& {
    Judged& judged = target_judged[k];
    if (judged.is_known) return judged;
    judged.is_known = true;
    judged.bodies = bodies_.target_arm_at(of_target.all[k].joints_rad);
    judged.is_free = bodies_.is_target_arm_free(judged.bodies, hull);
    if (!judged.is_free) return judged;
    judged.hidden = TestbedBodies::hidden_by_target_arm(judged.bodies, eye, points);
    judged.shaded = bodies_.shaded_by(judged.bodies, towards_lamp, lit);
    return judged;
  };
  // The best of this trial only: its neighbours differ little.
  double bound = search.bound();
  std::optional<Placement> best;
  bool collides = false, hides = false;
  for (std::size_t c = 0; c < of_camera.count; ++c) {
    const Candidate& camera = of_camera.all[c];
    const ProgressLimits one =
        TestbedAxisLimits::slower_of(carriage, limits.of_camera_arm(search.from.camera_rad, camera.joints_rad));
    for (std::size_t t = 0; t < of_target.count; ++t) {
      const Candidate& target = of_target.all[t];
      const ProgressLimits both =
          TestbedAxisLimits::slower_of(one, limits.of_target_arm(search.from.target_rad, target.joints_rad));
      const double arms_s = std::isfinite(both.speed) ? rest_to_rest_s(1.0, both) : 0.0;
      Placement placement{{camera.joints_rad, target.joints_rad, carriage_m},
                          lamp_rad,
                          sun_error_rad,
                          0,
                          0,
                          std::max(arms_s, lamp_s),
                          0.0};
      placement.cost_s = placement.move_s + camera.penalty_s + target.penalty_s + earth_s;
      if (!(placement.cost_s < bound)) continue;
      const Judged &camera_arm = of_camera_arm(c), &target_arm = of_target_arm(t);
      if (!camera_arm.is_free || !target_arm.is_free) {
        collides = true;
        continue;
      }
      placement.hidden = std::popcount(camera_arm.hidden | target_arm.hidden);
      placement.shaded = std::popcount(camera_arm.shaded | target_arm.shaded);
      placement.cost_s += settings_.hidden_cost_s * placement.hidden + settings_.shaded_cost_s * placement.shaded;
      if (placement.hidden > settings_.max_hidden) {
        hides = true;
        continue;
      }
      if (!(placement.cost_s < bound)) continue;
      if (!bodies_.are_apart(camera_arm.bodies, target_arm.bodies, hull)) {
        collides = true;
        continue;
      }
      bound = placement.cost_s;
      best = placement;
    }
  }
  if (best) {
    search.keep(*best, trial);
  } else if (hides) {
    ++search.counts.too_hidden;
  } else if (collides) {
    ++search.counts.colliding;
  }
}

void PlacementSearch::judge(const Trial& trial, Search& search) const {
  const Scene& scene = search.scene;
  const Vector3 p_C = scene.T_C_T.translation();
  const double lower = bench_.lamp.azimuth_low_rad, upper = bench_.lamp.azimuth_high_rad;
  const auto pose = [&](const Matrix3& R_L_C, double lamp_rad) {
    Eigen::Isometry3d T_L_C = Eigen::Isometry3d::Identity();
    T_L_C.linear() = R_L_C;
    T_L_C.translation() = trial.target_L - R_L_C * p_C;
    const double error = search.is_sun_free ? 0.0 : angle_between(R_L_C * scene.sun_C, Lamp::direction(lamp_rad));
    judge_pose(trial, T_L_C, T_L_C * scene.T_C_T, lamp_rad, error, search);
  };
  if (search.is_sun_free || search.is_turn_free) {
    // The camera keeps its roll, as far as the line of sight permits.
    const Vector3 x_C = Vector3::UnitX(), u = towards_camera(trial.yaw, trial.pitch);
    const Matrix3 R_L_C = frame(-u, search.R_L_C_last * x_C) * frame(p_C, x_C).transpose();
    const Vector3 sun_L = R_L_C * scene.sun_C;
    const double wanted = std::atan2(-sun_L.y(), -sun_L.x());
    const double lamp_rad = search.is_sun_free ? search.lamp_rad.value_or(lower) : std::clamp(wanted, lower, upper);
    pose(R_L_C, lamp_rad);
    return;
  }
  const double cosine = std::cos(search.phase_rad) / std::cos(trial.pitch);
  bool is_lit = false;
  if (std::abs(cosine) <= 1.0) {
    const double aside = std::acos(cosine);
    for (const double side : {aside, -aside}) {
      // A lamp at the end of its arc determines the yaw.
      const double lamp_rad = std::clamp(trial.yaw + side, lower, upper), yaw = lamp_rad - side;
      if (std::abs(yaw) > kYaw_rad) continue;
      is_lit = true;
      const Vector3 u = towards_camera(yaw, trial.pitch);
      pose(frame(-u, Lamp::direction(lamp_rad)) * frame(p_C, scene.sun_C).transpose(), lamp_rad);
    }
  }
  if (!is_lit) ++search.counts.beyond_lamp;
}

std::variant<Placement, NoPlacement> PlacementSearch::chosen(Search& search, const PlacementFilter& is_taken) const {
  const auto is_good = [&](const Placement& placement) { return !is_taken || is_taken(placement.posture); };
  for (const auto& [placement, trial] : search.best)
    if (paths_.is_straight_free(search.from, placement.posture) && is_good(placement)) return placement;
  // Otherwise over a retracted posture.
  std::optional<Placement> found;
  double found_cost_s = kInfinity;
  for (const auto& [placement, trial] : search.best) {
    const auto path = paths_.plan(search.from, placement.posture);
    if (const Path* free = std::get_if<Path>(&path)) {
      const double move_s = free->cycles() * bench_.motion.cycle_s;
      const double cost_s = placement.cost_s - placement.move_s + move_s;
      if (cost_s >= found_cost_s || !is_good(placement)) continue;
      found_cost_s = cost_s;
      found = placement;
      found->move_s = move_s;
      found->cost_s = cost_s;
    } else {
      ++search.counts.blocked;
    }
  }
  if (found) return *found;
  NoPlacement none = search.counts;
  const std::array<std::pair<int, const char*>, 5> reasons{
      {{none.blocked, "every path to a placement is blocked"},
       {none.too_hidden, "an arm hides more points of the target than are accepted"},
       {none.colliding, "both arms, the target or the room would touch"},
       {none.beyond_reach, "the arms do not reach it within their limits"},
       {none.beyond_lamp, "the lamp cannot stand where the Sun is"}}};
  none.reason = fmt::format("no placement in {} trials", settings_.trials);
  // What got furthest.
  for (const auto& [count, reason] : reasons) {
    if (count == 0) continue;
    none.reason += fmt::format(": {}", reason);
    break;
  }
  return none;
}

std::variant<Placement, NoPlacement> PlacementSearch::find(const Scene& scene, const Posture& from, std::int64_t number,
                                                           std::optional<double> lamp_rad,
                                                           const PlacementFilter& is_taken) const {
  if (!is_usable(scene, from)) return NoPlacement{"the scene or the posture is not valid"};
  const Vector3 p_C = scene.T_C_T.translation();
  const double phase_rad = angle_between(-p_C, scene.sun_C);
  const Eigen::Isometry3d T_L_C = bodies_.arms().camera_pose(from), T_L_T = bodies_.arms().target_pose(from);
  Search search{.scene = scene,
                .from = from,
                .lamp_rad = lamp_rad,
                .R_L_C_last = T_L_C.linear(),
                .phase_rad = phase_rad,
                .is_turn_free = std::min(phase_rad, std::numbers::pi - phase_rad) < kFreeTurn_rad,
                .is_sun_free = scene.sunlit <= 0.0};
  const Vector3 centre = bench_.lamp.centre_m;
  const auto limited = [&](Trial trial) {
    trial.target_L = centre + (trial.target_L - centre).cwiseMax(-kBeamMiddle_m).cwiseMin(kBeamMiddle_m);
    trial.yaw = std::clamp(trial.yaw, -kYaw_rad, kYaw_rad);
    trial.pitch = std::clamp(trial.pitch, -kPitch_rad, kPitch_rad);
    trial.carriage_ahead_m = std::clamp(trial.carriage_ahead_m, -kCarriage_m, kCarriage_m);
    return trial;
  };
  const Vector3 u = (T_L_C.translation() - T_L_T.translation()).normalized();
  const Trial last = limited({T_L_T.translation(), std::atan2(-u.y(), -u.x()), std::asin(std::clamp(u.z(), -1.0, 1.0)),
                              from.carriage_m - T_L_C.translation().x()});
  engine::RandomStream random(settings_.seed, fmt::format("tron/placement/{}", number));
  const double range_m = p_C.norm();
  const auto anywhere = [&] {
    Trial trial;
    for (int k = 0; k < 3; ++k) trial.target_L[k] = centre[k] + random.uniform(-kBeamMiddle_m, kBeamMiddle_m);
    // Yaw and pitch that leave the camera within the room: at long range a small part of all.
    const Vector3 low = (bench_.room_low_m - trial.target_L) / range_m;
    const Vector3 high = (bench_.room_high_m - trial.target_L) / range_m;
    const double up =
        random.uniform(std::max(low.z(), -std::sin(kPitch_rad)), std::min(high.z(), std::sin(kPitch_rad)));
    const double aside = random.uniform(std::max(low.y(), -std::sin(kYaw_rad)), std::min(high.y(), std::sin(kYaw_rad)));
    trial.pitch = std::asin(up);
    trial.yaw = std::asin(std::clamp(-aside / std::cos(trial.pitch), -1.0, 1.0));
    trial.carriage_ahead_m = random.uniform(-kCarriage_m, kCarriage_m);
    return trial;
  };
  const auto near = [&](const Trial& middle, double spread) {
    Trial trial = middle;
    for (int k = 0; k < 3; ++k) trial.target_L[k] += spread * kNear_m * random.normal();
    trial.yaw += spread * kNear_rad * random.normal();
    trial.pitch += spread * kNear_rad * random.normal();
    trial.carriage_ahead_m += spread * kNearCarriage_m * random.normal();
    return limited(trial);
  };
  judge(last, search);
  // A scene that is hard to place gets more trials, which are not near a posture that does not suit it.
  const int longer = settings_.trials * settings_.extension, longest = settings_.trials * settings_.last_extension;
  for (int k = 1; k < longest; ++k) {
    const bool is_extended = k >= settings_.trials;
    if (is_extended && !search.best.empty() && (k >= longer || search.best.front().first.hidden == 0)) break;
    const int kind = is_extended ? 1 + k % 2 : k % 3;
    if (kind == 0) {
      judge(near(last, 1.0), search);
    } else if (kind == 1 || search.best.empty()) {
      judge(anywhere(), search);
    } else {
      judge(near(search.best.front().second, kRefinement), search);
    }
  }
  return chosen(search, is_taken);
}

}  // namespace vbar::tron
