#pragma once
// Placement of a scene, paths of both arms, and postures by the calibrated arms.

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "hil_drivers/tron/calibration_file/calibration.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/kinematics/geometry.h"
#include "hil_drivers/tron/placement/placement.h"

namespace vbar::tron {

/// A path as robots follow it.
[[nodiscard]] Motion motion_along(const BenchFile& bench, const std::vector<Posture>& corners);

class ArmPlanner final : public MotionPlanner {
 public:
  ArmPlanner(const BenchFile& bench, const Calibration& calibration, const PlacementSettings& settings,
             const std::vector<fsw::Vector3>& keypoints_m);

  [[nodiscard]] std::variant<Place, NoPlace> place(const Scene& scene, const Posture& from,
                                                   std::int64_t image) override;
  [[nodiscard]] std::variant<Motion, NoPlace> path(const Posture& from, const Posture& to) override;
  [[nodiscard]] std::optional<Posture> corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) override;

 private:
  const Calibration& calibration_;
  Geometry geometry_;
  CollisionCheck collisions_;
  PlacementSearch search_;
};

}  // namespace vbar::tron
