#include "hil_drivers/tron/bench/world/true_arm.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil_drivers/tron/bench/world/draws.h"
#include "host_sim/engine/distributions.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

using engine::RandomStream;
using fsw::Vector3;

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

}  // namespace vbar::tron::bench
