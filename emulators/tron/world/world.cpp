#include "emulators/tron/world/world.h"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {

using fsw::Vector3;

Eigen::Isometry3d drawn_pose(std::uint64_t seed, const std::string& stream, double rotation_deg,
                             double translation_mm) {
  engine::RandomStream random(seed, stream);
  Vector3 turn, shift;
  for (double& component : turn) component = random.normal() * rotation_deg * std::numbers::pi / 180.0;
  for (double& component : shift) component = random.normal() * 1e-3 * translation_mm;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double angle = turn.norm();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  pose.translation() = shift;
  return pose;
}

Wave::Wave(std::uint64_t seed, const std::string& stream, double sigma, double wavelength_low, double wavelength_high) {
  engine::RandomStream random(seed, stream);
  const double share = sigma / std::sqrt(static_cast<double>(parts_.size()));
  for (Part& part : parts_) {
    part.wavenumber = 2.0 * std::numbers::pi / random.uniform(wavelength_low, wavelength_high);
    part.sine = share * random.normal();
    part.cosine = share * random.normal();
  }
}

double Wave::at(double place) const {
  double sum = 0.0;
  for (const Part& part : parts_) {
    const double angle = part.wavenumber * place;
    sum += part.sine * std::sin(angle) + part.cosine * std::cos(angle);
  }
  return sum;
}

namespace {

using engine::RandomStream;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kA2 = 1, kA3 = 2, kWrist = 4;
constexpr int kMostGearPeriods = 3;

}  // namespace

TrueArm::TrueArm(const ArmDesign& design, double up, const ErrorSizes& sizes, std::uint64_t seed,
                 const std::string& name)
    : flange_m_(design.d6_m),
      up_(up),
      repeatability_rad_(sizes.repeatability_deg * kDegree),
      seed_(seed),
      name_("bench/" + name) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  const std::array<Vector3, kJoints> axes{-z, y, y, -x, y, -x};
  const std::array<Vector3, kJoints> before{design.d1_m * z, design.a1_m * x, design.a2_m * x,
                                            design.a3_m * z, design.d4_m * x, Vector3::Zero()};
  RandomStream offsets(seed, name_ + "/joint_offset");
  RandomStream gears(seed, name_ + "/gear");
  RandomStream flexes(seed, name_ + "/flex");
  for (std::size_t k = 0; k < kJoints; ++k) {
    Joint& joint = joints_[k];
    joint.axis = axes[k];
    joint.before_m = before[k];
    joint.offset_rad = sizes.joint_offset_deg * kDegree * offsets.normal();
    joint.gear_rad = sizes.gear_deg * kDegree * gears.normal();
    joint.gear_phase_rad = gears.uniform(0.0, 2.0 * std::numbers::pi);
    joint.gear_periods = 1 + static_cast<int>(gears.bits() % kMostGearPeriods);
    joint.error_after =
        drawn_pose(seed, fmt::format("{}/link/{}", name_, k + 1), sizes.link_rotation_deg, sizes.link_translation_mm);
  }
  const double a2 = sizes.flex_deg_m * kDegree, a3 = sizes.flex_ratio_a3 * a2;
  joints_[kA2].flex_rad_m = a2 * (1.0 + sizes.flex_spread * flexes.normal());
  joints_[kA3].flex_rad_m = a3 * (1.0 + sizes.flex_spread * flexes.normal());
}

std::array<double, 2> TrueArm::levers_m(const Joints& angles_rad) const {
  // In the plane of the arm, x ahead and z up: A2 and A3 turn about the same direction.
  Vector3 place = Vector3::Zero();
  double turned = 0.0, at_a2 = 0.0, at_a3 = 0.0;
  for (std::size_t k = kA2; k <= kWrist; ++k) {
    const Joint& joint = joints_[k];
    const Vector3 step(joint.before_m.x(), 0.0, joint.before_m.z());
    place += Eigen::AngleAxisd(turned, Vector3::UnitY()) * step;
    if (k == kA2) at_a2 = place.x();
    if (k == kA3) at_a3 = place.x();
    if (k == kA2 || k == kA3) turned += angles_rad[static_cast<Eigen::Index>(k)];
  }
  return {place.x() - at_a2, place.x() - at_a3};
}

Joints TrueArm::true_angles(const Joints& encoder_rad) const {
  Joints angles;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const Joint& joint = joints_[k];
    angles[at] = encoder_rad[at] + joint.offset_rad +
                 joint.gear_rad * std::sin(joint.gear_periods * encoder_rad[at] + joint.gear_phase_rad);
  }
  // Weight ahead of an axis along +y turns an arm that stands forward, and one that hangs back.
  const auto levers = levers_m(angles);
  angles[kA2] += up_ * joints_[kA2].flex_rad_m * levers[0];
  angles[kA3] += up_ * joints_[kA3].flex_rad_m * levers[1];
  return angles;
}

Eigen::Isometry3d TrueArm::T_base_flange(const Joints& encoder_rad) const {
  const Joints angles = true_angles(encoder_rad);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < kJoints; ++k) {
    const Joint& joint = joints_[k];
    pose = pose * Eigen::Translation3d(joint.before_m) *
           Eigen::AngleAxisd(angles[static_cast<Eigen::Index>(k)], joint.axis) * joint.error_after;
  }
  return pose * Eigen::Translation3d(flange_m_ * Vector3::UnitX()) *
         Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitY());
}

Joints TrueArm::repeatability_rad(std::uint64_t number) const {
  const RandomStream stream(seed_, name_ + "/repeatability");
  Joints deviation;
  for (std::uint64_t half = 0; half < 2; ++half) {
    const auto uniforms = stream.uniforms_of(2 * number + half);
    for (std::size_t k = 0; k < 3; ++k)
      deviation[static_cast<Eigen::Index>(3 * half + k)] = repeatability_rad_ * engine::normal_quantile(uniforms[k]);
  }
  return deviation;
}

namespace {

constexpr double kWavelengthLow_m = 2.5, kWavelengthHigh_m = 5.0;

Wave wave(std::uint64_t seed, const char* error, double sigma) {
  return {seed, std::string("bench/track/") + error, sigma, kWavelengthLow_m, kWavelengthHigh_m};
}

Wave rotation_wave(std::uint64_t seed, const char* error, double sigma_deg) {
  return wave(seed, error, sigma_deg * (std::numbers::pi / 180.0));
}

}  // namespace

TrueTrack::TrueTrack(const Track& design, const BasePose& base, const ErrorSizes& sizes, std::uint64_t seed)
    : design_(design),
      base_(base),
      scale_(sizes.track_scale * RandomStream(seed, "bench/track/scale").normal()),
      repeatability_m_(1e-3 * sizes.track_repeatability_mm),
      sideways_m_(wave(seed, "sideways", 1e-3 * sizes.track_offset_mm)),
      height_m_(wave(seed, "height", 1e-3 * sizes.track_offset_mm)),
      roll_rad_(rotation_wave(seed, "roll", sizes.track_rotation_deg)),
      pitch_rad_(rotation_wave(seed, "pitch", sizes.track_rotation_deg)),
      yaw_rad_(rotation_wave(seed, "yaw", sizes.track_rotation_deg)),
      seed_(seed) {}

Eigen::Isometry3d TrueTrack::T_L_base(double encoder_m) const {
  const double place_m = encoder_m + scale_ * (encoder_m - design_.home_m);
  const Vector3 carriage_m(place_m, sideways_m_.at(place_m), height_m_.at(place_m));
  const Eigen::Isometry3d base = base_.T_L_base();
  return Eigen::Translation3d(carriage_m + base.translation()) *
         Eigen::AngleAxisd(yaw_rad_.at(place_m), Vector3::UnitZ()) *
         Eigen::AngleAxisd(pitch_rad_.at(place_m), Vector3::UnitY()) *
         Eigen::AngleAxisd(roll_rad_.at(place_m), Vector3::UnitX()) * Eigen::Isometry3d(base.rotation());
}

double TrueTrack::repeatability_m(std::uint64_t number) const {
  const RandomStream stream(seed_, "bench/track/repeatability");
  return repeatability_m_ * engine::normal_quantile(stream.uniforms_of(number)[0]);
}

namespace {

constexpr std::array<const char*, kMountedThings> kPlateStreams{"bench/plate/target", "bench/plate/board",
                                                                "bench/plate/patch"};

/// +1 where the base's z points up.
double up_of(const Robot& robot) {
  return robot.base.T_L_base().linear()(2, 2) < 0.0 ? -1.0 : 1.0;
}

}  // namespace

World::World(const TestbedDesign& laboratory, const std::array<Eigen::Isometry3d, kMountedThings>& T_flange_mounted,
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
