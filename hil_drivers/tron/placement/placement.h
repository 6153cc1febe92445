#pragma once
// From a scene to where arms, carriage and lamp shall be. Only the relative pose and the light matter, so the common
// position and turn in the laboratory are free: place of the target, direction of the line of sight, carriage. They are
// searched at random, most of them near the last ones, for the shortest move that hides least of the target.

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hil_drivers/tron/kinematics/geometry.h"
#include "hil_drivers/tron/placement/collision.h"
#include "hil_drivers/tron/placement/scene.h"

namespace vbar::tron {

/// The free parameters.
struct FreePlace {
  fsw::Vector3 target_L = fsw::Vector3::Zero();  ///< middle of the target's hull
  double yaw_rad = 0.0, pitch_rad = 0.0;         ///< of the direction from the target to the camera: 0 towards -x
  double carriage_offset_m = 0.0;                ///< of the carriage from the camera
};

struct Placement {
  Posture posture;
  double lamp_azimuth_rad = 0.0;
  double sun_error_rad = 0.0;
  int hidden = 0;
  std::vector<Posture> way;  ///< corners, from where the arms stood to `posture`
  double move_s = 0.0;       ///< along the way
  double cost_s = 0.0;
  FreePlace free;
};

/// Why no trial was accepted: how many were refused for each reason.
struct NoPlacement {
  int lamp = 0;       ///< the lamp's arc does not meet the direction of the Sun
  int reach = 0;      ///< an arm does not reach, or an axis is at a limit
  int collision = 0;  ///< at the end or on the way
  int hidden = 0;     ///< too much of the target
  [[nodiscard]] std::string reason() const;
};

struct PlacementSettings {
  int trials = 400;  ///< of a round
  int rounds = 10;   ///< at most, while nothing was found that hides nothing
  int max_hidden = 3;
  std::uint64_t seed = 1;
  double hidden_cost_s = 0.6;  ///< of each hidden point
};

class PlacementSearch {
 public:
  /// `points_T`: keypoints and centre in T, laboratory lengths.
  PlacementSearch(const Geometry& geometry, const PlacementSettings& settings, std::vector<fsw::Vector3> points_T);

  /// The best of the trials for image `number` to which a way from `from` is free. Near trials are about the last
  /// placement found. Same scenes in the same order, same answers.
  [[nodiscard]] std::variant<Placement, NoPlacement> find(const Scene& scene, const Posture& from, std::int64_t number);

  /// One trial; nothing if lamp or arms do not reach it. Collisions and lines of sight are not looked at.
  [[nodiscard]] std::optional<Placement> at(const FreePlace& free, const Scene& scene, const Posture& from,
                                            NoPlacement& refused) const;

 private:
  void choose(std::vector<Placement>& candidates, const Posture& from, std::optional<Placement>& best,
              NoPlacement& refused) const;
  [[nodiscard]] double penalty_s(const Posture& posture) const;
  [[nodiscard]] bool cable_allows(const Posture& posture) const;

  const Geometry& geometry_;
  PlacementSettings settings_;
  std::vector<fsw::Vector3> points_T_;
  CollisionCheck collisions_;
  std::vector<AxisLimits> limits_;
  std::optional<FreePlace> last_;
};

/// The target's keypoints and the middle of its hull in T.
[[nodiscard]] std::vector<fsw::Vector3> points_of_target(const BenchFile& bench,
                                                         const std::vector<fsw::Vector3>& keypoints_m);

}  // namespace vbar::tron
