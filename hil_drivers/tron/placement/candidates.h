#pragma once
// Postures of one arm for a pose of its flange, with the costs of each.

#include <array>
#include <cstddef>
#include <optional>

#include "hil_drivers/tron/kinematics/arm.h"

namespace vbar::tron {

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

}  // namespace vbar::tron
