#include "hil_drivers/tron/motion_planning/arm_planner.h"

#include <algorithm>
#include <memory>

#include "host_sim/twins/camera/earth_disc.h"

namespace vbar::tron {

using fsw::Matrix3;
using fsw::Vector3;

std::optional<Scene> scene_of(const twins::camera::Exposure& exposure, const std::string& model, double scale) {
  const auto object = std::ranges::find(exposure.objects, model, &twins::camera::ObjectInView::model);
  if (object == exposure.objects.end()) return std::nullopt;
  const Matrix3 R_camera_eci = exposure.q_camera_eci.normalized().toRotationMatrix();
  Scene scene;
  scene.T_C_T.linear() = R_camera_eci * object->q_body_eci.normalized().toRotationMatrix().transpose();
  scene.T_C_T.translation() = scale * (R_camera_eci * object->position_eci);
  scene.sun_C = (R_camera_eci * (exposure.sun_eci - exposure.camera_position_eci)).normalized();
  const twins::camera::EarthDisc earth(exposure.camera_position_eci, exposure.sun_eci);
  const Vector3 light_C = R_camera_eci * earth.light_eci(1.0);
  scene.earth_to_sun = light_C.norm();
  if (scene.earth_to_sun > 0.0) scene.earth_C = light_C.normalized();
  scene.earth_half_angle = earth.angular_radius();
  scene.sunlit = object->sunlit;
  return scene;
}

Motion motion_along(const Path& path) {
  const auto shared = std::make_shared<const Path>(path);
  Motion motion;
  motion.cycles = path.cycles();
  motion.at = [shared](int cycle) { return shared->at(cycle); };
  motion.stop_after = [shared](int cycle) { return motion_along(shared->stop_after(cycle)); };
  return motion;
}

ArmPlanner::ArmPlanner(const TestbedDesign& bench, const Calibration& calibration, const PlacementSettings& settings,
                       const std::filesystem::path& data_directory)
    : calibration_(calibration),
      bodies_(bench),
      paths_(bench, bodies_),
      search_(bench, bodies_, paths_, bodies_.points_to_see(data_directory), settings) {}

/// The scene as camera and target would see it on the mounts of the design. What else differs from the design, some
/// tenths of a degree and millimetres, the correction of the posture makes up for.
Scene ArmPlanner::on_designed_mounts(const Scene& scene) const {
  const ArmPair& arms = bodies_.arms();
  const Eigen::Isometry3d T_designed_C = arms.T_flange_camera().inverse() * calibration_.camera_arm.mount.isometry();
  const Eigen::Isometry3d T_T_designed = calibration_.target_arm.mount.isometry().inverse() * arms.T_flange_target();
  Scene designed = scene;
  designed.T_C_T = T_designed_C * scene.T_C_T * T_T_designed;
  designed.sun_C = T_designed_C.linear() * scene.sun_C;
  designed.earth_C = T_designed_C.linear() * scene.earth_C;
  return designed;
}

std::variant<Place, PlacementFailure> ArmPlanner::place(const Scene& scene, const Posture& from, std::int64_t image) {
  // Some millimetres from a free posture the calibrated one may be too near a wall.
  const auto is_reached = [&](const Posture& posture) {
    const auto calibrated = corrected(posture, scene.T_C_T);
    return calibrated && std::holds_alternative<Path>(paths_.plan(from, *calibrated));
  };
  const auto found = search_.find(on_designed_mounts(scene), from, image, lamp_rad_, is_reached);
  if (const auto* const none = std::get_if<NoPlacement>(&found)) return PlacementFailure{none->reason};
  const auto& placement = std::get<Placement>(found);
  lamp_rad_ = placement.lamp_azimuth_rad;
  return Place{placement.posture, placement.lamp_azimuth_rad, placement.sun_error_rad, placement.hidden,
               placement.shaded};
}

std::variant<Motion, PlacementFailure> ArmPlanner::path(const Posture& from, const Posture& to) {
  const auto found = paths_.plan(from, to);
  if (const auto* const none = std::get_if<PathFailure>(&found)) return PlacementFailure{none->reason};
  return motion_along(std::get<Path>(found));
}

std::optional<Posture> ArmPlanner::corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) {
  // The calibrated arms differ from the designed ones by a pose that changes little with the posture: each iteration
  // takes it as constant.
  constexpr int kIterations = 8;
  constexpr double kReached_m = 1e-6, kReached_rad = 1e-6;
  Posture at = from;
  for (int k = 0; k < kIterations; ++k) {
    const Eigen::Isometry3d reached = T_C_T_of_arms(calibration_, at);
    const Eigen::Isometry3d left = reached.inverse() * T_C_T;
    if (left.translation().norm() < kReached_m && Eigen::AngleAxisd(left.linear()).angle() < kReached_rad) return at;
    const auto next = bodies_.arms().correct(at, reached, T_C_T);
    if (!next) return std::nullopt;
    at = *next;
  }
  return at;
}

}  // namespace vbar::tron
