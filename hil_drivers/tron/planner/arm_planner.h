#pragma once
// Placement of a scene, paths of both arms, and postures by the calibrated arms.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>

#include "hil_drivers/tron/calibration_file/calibration.h"
#include "hil_drivers/tron/collision/bench_bodies.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/motion/path_planner.h"
#include "hil_drivers/tron/placement/placement.h"

namespace vbar::tron {

/// Returns the path as a motion that robots follow.
[[nodiscard]] Motion motion_along(const Path& path);

class ArmPlanner final : public MotionPlanner {
 public:
  ArmPlanner(const BenchFile& bench, const Calibration& calibration, const PlacementSettings& settings,
             const std::filesystem::path& data_directory);

  [[nodiscard]] std::variant<Place, NoPlace> place(const Scene& scene, const Posture& from,
                                                   std::int64_t image) override;
  [[nodiscard]] std::variant<Motion, NoPlace> path(const Posture& from, const Posture& to) override;
  [[nodiscard]] std::optional<Posture> corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) override;

 private:
  [[nodiscard]] Scene on_designed_mounts(const Scene& scene) const;

  const Calibration& calibration_;
  BenchBodies bodies_;
  PathPlanner paths_;
  PlacementSearch search_;
  std::optional<double> lamp_rad_;
};

}  // namespace vbar::tron
