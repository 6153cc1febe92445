#include "hil_drivers/tron/bench/world/world.h"

#include <string>

#include "hil_drivers/tron/bench/world/draws.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

using engine::RandomStream;

constexpr std::array<const char*, kMountedThings> kPlateStreams{"bench/plate/target", "bench/plate/board",
                                                                "bench/plate/patch"};

/// +1 where the base's z points up.
double up_of(const Robot& robot) {
  return robot.base.T_L_base().linear()(2, 2) < 0.0 ? -1.0 : 1.0;
}

}  // namespace

World::World(const BenchFile& laboratory, const std::array<Eigen::Isometry3d, kMountedThings>& T_flange_mounted,
             const ErrorSizes& sizes, std::uint64_t seed)
    : camera_arm_(laboratory.camera_robot.design, up_of(laboratory.camera_robot), sizes, seed, "camera_arm"),
      target_arm_(laboratory.target_robot.design, up_of(laboratory.target_robot), sizes, seed, "target_arm"),
      track_(laboratory.track, laboratory.camera_robot.base, sizes, seed),
      T_L_target_base_(laboratory.target_robot.base.T_L_base() *
                       drawn_pose(seed, "bench/target_base", sizes.base_rotation_deg, sizes.base_translation_mm)),
      T_flange_camera_(laboratory.camera.T_flange_camera() *
                       drawn_pose(seed, "bench/mount/camera", sizes.mount_rotation_deg, sizes.mount_translation_mm)) {
  // The plate is off from its place before the flange; what hangs on it is where it was measured to be on the plate.
  const Eigen::Translation3d ahead(laboratory.target.stand_off_m * fsw::Vector3::UnitZ());
  const Eigen::Isometry3d plate =
      ahead * drawn_pose(seed, "bench/mount/plate", sizes.mount_rotation_deg, sizes.mount_translation_mm) *
      ahead.inverse();
  for (std::size_t k = 0; k < kMountedThings; ++k)
    T_flange_mounted_[k] = plate * T_flange_mounted[k] *
                           drawn_pose(seed, kPlateStreams[k], sizes.plate_rotation_deg, sizes.plate_translation_mm);
}

void World::slip(double x_m) {
  for (Eigen::Isometry3d& T : T_flange_mounted_) T = T * Eigen::Translation3d(x_m * fsw::Vector3::UnitX());
}

Eigen::Isometry3d World::T_L_camera_base(const Posture& posture) const {
  return track_.T_L_base(posture.carriage_m);
}

Eigen::Isometry3d World::T_L_C(const Posture& posture) const {
  return T_L_camera_base(posture) * camera_arm_.T_base_flange(posture.camera_rad) * T_flange_camera_;
}

Eigen::Isometry3d World::T_L_mounted(const Posture& posture, Mounted mounted) const {
  return T_L_target_base_ * target_arm_.T_base_flange(posture.target_rad) *
         T_flange_mounted_[static_cast<std::size_t>(mounted)];
}

Eigen::Isometry3d World::T_C_mounted(const Posture& posture, Mounted mounted) const {
  return T_L_C(posture).inverse() * T_L_mounted(posture, mounted);
}

twins::camera::CameraSettings with_lens_errors(const twins::camera::CameraSettings& design, const ErrorSizes& sizes,
                                               std::uint64_t seed) {
  RandomStream random(seed, "bench/lens");
  twins::camera::CameraSettings camera = design;
  camera.optics.focal_length_mm *= 1.0 + sizes.focal_length * random.normal();
  for (double& px : camera.optics.principal_point_px) px += sizes.principal_point_px * random.normal();
  for (double& coefficient : camera.optics.distortion) coefficient *= 1.0 + sizes.distortion * random.normal();
  return camera;
}

}  // namespace vbar::tron::bench
