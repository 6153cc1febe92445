#pragma once
// Placement of a scene, paths of both arms, and postures by the calibrated arms.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <variant>

#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/collision.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "hil_drivers/tron/motion_planning/path.h"
#include "hil_drivers/tron/motion_planning/placement.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::tron {

// Conversion of an exposure in orbit to the scene of the laboratory.

/// Returns the scene with the target of that CAD model, lengths times `scale`. Nothing if the exposure has no such
/// object.
[[nodiscard]] std::optional<Scene> scene_of(const twins::camera::Exposure& exposure, const std::string& model,
                                            double scale);

/// Returns the path as a motion that robots follow.
[[nodiscard]] Motion motion_along(const Path& path);

class ArmPlanner final : public MotionPlanner {
 public:
  ArmPlanner(const TestbedDesign& bench, const Calibration& calibration, const PlacementSettings& settings,
             const std::filesystem::path& data_directory);

  [[nodiscard]] std::variant<Place, PlacementFailure> place(const Scene& scene, const Posture& from,
                                                            std::int64_t image) override;
  [[nodiscard]] std::variant<Motion, PlacementFailure> path(const Posture& from, const Posture& to) override;
  [[nodiscard]] std::optional<Posture> corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) override;

 private:
  [[nodiscard]] Scene on_designed_mounts(const Scene& scene) const;

  const Calibration& calibration_;
  TestbedBodies bodies_;
  PathPlanner paths_;
  PlacementSearch search_;
  std::optional<double> lamp_rad_;
};

}  // namespace vbar::tron
