#include "emulators/tron/truth.h"

#include <numbers>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "hil_drivers/tron/geometry/kinematics.h"

namespace vbar::tron::bench {

namespace {

using fsw::Vector3;

constexpr double kColumn_m = 0.12, kUpperArm_m = 0.09, kForearm_m = 0.07, kHand_m = 0.045;
/// Markers of the camera stand on a frame around its body.
constexpr double kCameraFrame_m = 0.12;

void add_arm(const Eigen::Isometry3d& T_L_base, const ArmPoints& points, std::vector<Capsule>& capsules) {
  capsules.push_back({T_L_base.translation(), T_L_base * points.shoulder, kColumn_m});
  capsules.push_back({T_L_base * points.shoulder, T_L_base * points.elbow, kUpperArm_m});
  capsules.push_back({T_L_base * points.elbow, T_L_base * points.wrist, kForearm_m});
  capsules.push_back({T_L_base * points.wrist, T_L_base * points.flange, kHand_m});
}

}  // namespace

CaptureView::CaptureView(const TestbedDesign& laboratory, const World& world)
    : laboratory_(laboratory), world_(world), cameras_(laboratory) {
  const Vector3 frame = Vector3::Constant(kCameraFrame_m);
  const double body_m = laboratory.camera.body_radius_m;
  objects_[0] = {markers_of_box(-frame, frame), {-body_m, -body_m, -laboratory.camera.ahead_m}, {body_m, body_m, 0.0}};
  const Vector3 low = laboratory.scale * laboratory.target.body_low_m;
  const Vector3 high = laboratory.scale * laboratory.target.body_high_m;
  objects_[1] = {markers_of_box(low, high), low, high};
}

Eigen::Isometry3d CaptureView::T_L_body(CaptureObject object, const Posture& posture) const {
  return object == CaptureObject::kCamera ? world_.T_L_C(posture) : world_.T_L_mounted(posture, Mounted::kTarget);
}

std::vector<Capsule> CaptureView::arms(const Posture& posture) const {
  std::vector<Capsule> capsules;
  add_arm(world_.T_L_camera_base(posture), Arm(laboratory_.camera_robot.design).points(posture.camera_rad), capsules);
  add_arm(world_.T_L_target_base(), Arm(laboratory_.target_robot.design).points(posture.target_rad), capsules);
  return capsules;
}

std::size_t CaptureView::located(CaptureObject object, const Posture& posture) const {
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < kCaptureObjects; ++k)
    blocks.push_back({T_L_body(static_cast<CaptureObject>(k), posture), objects_[k].low_m, objects_[k].high_m});
  return cameras_.located(T_L_body(object, posture), objects_[static_cast<std::size_t>(object)].markers, arms(posture),
                          blocks);
}

std::array<std::size_t, kCaptureObjects> CaptureView::located(const Posture& posture) const {
  return {located(CaptureObject::kCamera, posture), located(CaptureObject::kTarget, posture)};
}

std::optional<Eigen::Isometry3d> CaptureView::tracked(CaptureObject object, const Posture& posture) const {
  if (located(object, posture) < ViconVisibility::kMinMarkers) return std::nullopt;
  return T_L_body(object, posture);
}

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr std::array<const char*, kMountedThings> kMountedNames{"target", "board", "patch"};

std::string header() {
  std::string line =
      "image,cycle,bench_s,exposure_s,mounted,C_x_m,C_y_m,C_z_m,q_C_T_w,q_C_T_x,q_C_T_y,q_C_T_z,carriage_m";
  for (std::size_t k = 1; k <= kJoints; ++k) line += fmt::format(",camera_A{}_deg", k);
  for (std::size_t k = 1; k <= kJoints; ++k) line += fmt::format(",target_A{}_deg", k);
  line += ",lamp_power,lamp_azimuth_deg";
  for (std::size_t k = 1; k <= kBoxes; ++k) line += fmt::format(",box{}_power", k);
  return line + ",markers_of_camera,markers_of_target";
}

}  // namespace

TruthLog::TruthLog(const std::filesystem::path& file) : file_(file) {
  if (!file_) throw std::runtime_error(fmt::format("{}: cannot be made", file.string()));
  file_ << header() << std::endl;
}

void TruthLog::write(const TrueExposure& exposure) {
  const fsw::Vector3 r = exposure.T_C_mounted.translation();
  Eigen::Quaterniond q(exposure.T_C_mounted.rotation());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  std::string line =
      fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", exposure.image, exposure.cycle, exposure.bench_s,
                  exposure.exposure_s, kMountedNames[static_cast<std::size_t>(exposure.mounted)], r.x(), r.y(), r.z(),
                  q.w(), q.x(), q.y(), q.z(), exposure.posture.carriage_m);
  for (const double rad : exposure.posture.camera_rad) line += fmt::format(",{}", rad * kDegreesPerRadian);
  for (const double rad : exposure.posture.target_rad) line += fmt::format(",{}", rad * kDegreesPerRadian);
  line += fmt::format(",{},{}", exposure.lamp_power, exposure.lamp_azimuth_rad * kDegreesPerRadian);
  for (const double power : exposure.box_power) line += fmt::format(",{}", power);
  line += fmt::format(",{},{}", exposure.markers_of_camera, exposure.markers_of_target);
  file_ << line << std::endl;
}

}  // namespace vbar::tron::bench
