#pragma once
// From a relative pose and the Sun's direction to the joints of both arms, the carriage and the lamp.
//
// Only the relative pose and the light matter, so the common position and rotation of the scene in the laboratory are
// free: target position (3), yaw and pitch of the line of sight, place of the carriage. A trial of these six gives the
// lamp's azimuth and both poses in closed form; the search takes the best of many.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "hil_drivers/tron/geometry/collision.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "hil_drivers/tron/motion_planning/path.h"

namespace vbar::tron {

// Postures of one arm for a pose of its flange, with the costs of each.

struct CandidateRules {
  double limit_margin_rad = 0.0;         ///< closer to a limit costs
  std::optional<double> cable_turn_rad;  ///< largest |A4 + A6|
};

struct Candidate {
  Joints joints_rad;
  double penalty_s = 0.0;  ///< near limits and singularities
};

struct Candidates {
  std::array<Candidate, kBranches> all;
  std::size_t count = 0;
};

/// Returns, for each branch within limits, the full turns nearest to `from`.
[[nodiscard]] Candidates candidates(const Arm& arm, const Eigen::Isometry3d& T_base_flange, const Joints& from,
                                    const CandidateRules& rules);

struct Placement {
  Posture posture;
  double lamp_azimuth_rad = 0.0;
  double sun_error_rad = 0.0;  ///< between the Sun of the scene and the lamp
  int hidden = 0;              ///< points that an arm or the rod hides
  int shaded = 0;              ///< lit points of the hull in the shadow of an arm
  double move_s = 0.0;         ///< duration of the straight path, the lamp's travel included
  double cost_s = 0.0;
};

/// States why there is no placement, one sentence, and the number of trials that ended at each check.
struct NoPlacement {
  std::string reason;
  int beyond_reach = 0, beyond_lamp = 0, colliding = 0, too_hidden = 0, blocked = 0;
};

struct PlacementSettings {
  int trials = 400;
  int extension = 10;          ///< times as many trials while nothing without hidden points was found,
  int last_extension = 40;     ///< and while nothing was found at all
  int max_hidden = 3;          ///< points that may be hidden
  std::uint64_t seed = 1;      ///< random stream of the trials
  double hidden_cost_s = 4.0;  ///< cost of each hidden point
  double shaded_cost_s = 1.0;  ///< cost of each lit point of the hull, four a face, in an arm's shadow
};

/// Returns the cost, s, of the Earth's light that the boxes cannot make at a pose of camera and target in L.
using EarthLightCost =
    std::function<double(const Scene&, const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_T)>;

/// Returns true if a placement is accepted; for instance if the arms as calibrated reach it.
using PlacementFilter = std::function<bool(const Posture&)>;

class PlacementSearch {
 public:
  /// `bodies` and `paths` must outlive the search. `points_body`: points that the camera has to see, full-scale body
  /// frame.
  PlacementSearch(const TestbedDesign& bench, const TestbedBodies& bodies, const PathPlanner& paths,
                  std::vector<fsw::Vector3> points_body, const PlacementSettings& settings, EarthLightCost earth = {});

  /// Finds a placement free of collisions, with a free path from `from`. The same scene, posture, lamp and number give
  /// the same result. `lamp_rad`: where the lamp is; none: its travel costs nothing. `is_taken`: asked last, of few.
  [[nodiscard]] std::variant<Placement, NoPlacement> find(const Scene& scene, const Posture& from, std::int64_t number,
                                                          std::optional<double> lamp_rad = std::nullopt,
                                                          const PlacementFilter& is_taken = {}) const;

 private:
  struct Trial;
  struct Search;
  void judge(const Trial& trial, Search& search) const;
  void judge_pose(const Trial& trial, const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_T, double lamp_rad,
                  double sun_error_rad, Search& search) const;
  [[nodiscard]] std::variant<Placement, NoPlacement> chosen(Search& search, const PlacementFilter& is_taken) const;

  TestbedDesign bench_;
  const TestbedBodies& bodies_;
  const PathPlanner& paths_;
  std::vector<fsw::Vector3> points_body_;
  PlacementSettings settings_;
  EarthLightCost earth_;
};

}  // namespace vbar::tron
