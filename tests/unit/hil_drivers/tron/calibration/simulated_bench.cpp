#include "tests/unit/hil_drivers/tron/calibration/simulated_bench.h"

#include <cmath>
#include <numbers>

namespace vbar::tron::calibrate {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kDegree = pi / 180.0;

Isometry3d turn(double angle, const Vector3d& axis) {
  return Isometry3d(AngleAxisd(angle, axis));
}

}  // namespace

double SimulatedBench::Wave::at(double x_m) const {
  return amplitude * std::sin(2.0 * pi * x_m / wavelength_m + phase);
}

Isometry3d SimulatedBench::draw_pose(double rotation_rad, double place_m) {
  const Vector3d rotation = rotation_rad * Vector3d(random_.normal(), random_.normal(), random_.normal());
  const Vector3d place = place_m * Vector3d(random_.normal(), random_.normal(), random_.normal());
  Isometry3d pose = Isometry3d::Identity();
  if (rotation.norm() > 0.0) pose.linear() = AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  pose.translation() = place;
  return pose;
}

SimulatedBench::Arm SimulatedBench::draw_arm(const ArmDesign& design, double gravity, const Isometry3d& mount) {
  Arm arm;
  arm.lengths = ArmLengths::of(design);
  arm.gravity = gravity;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    arm.offset_rad[i] = 0.15 * kDegree * random_.normal();
    arm.gear_rad[i] = 0.006 * kDegree * random_.normal();
    arm.gear_phase[i] = random_.uniform(0.0, 2.0 * pi);
    arm.gear_periods[k] = std::floor(random_.uniform(1.0, 4.0));
  }
  for (auto& link : arm.link) link = draw_pose(0.03 * kDegree, 0.3e-3);
  arm.flex_rad_m = {0.05 * kDegree * std::abs(random_.normal()), 0.075 * kDegree * std::abs(random_.normal())};
  arm.mount = mount * draw_pose(1.5 * kDegree, 4e-3);
  return arm;
}

SimulatedBench::SimulatedBench(const TestbedDesign& bench, const LensCalibration& lens, std::uint64_t seed)
    : bench_(bench), random_(seed, "simulated/bench"), lens_(lens), T_T_B_(T_target_board(bench)) {
  camera_ = draw_arm(bench.camera_robot.design, -1.0, bench.camera.T_flange_camera());
  target_ = draw_arm(bench.target_robot.design, 1.0, bench.target.T_flange_target(bench.scale));
  target_base_ = bench.target_robot.base.T_L_base() * draw_pose(0.3 * kDegree, 5e-3);
  track_scale_ = 1e-4 * random_.normal();
  for (std::size_t e = 0; e < track_.size(); ++e) {
    const double sigma = e < 3 ? 0.035 * kDegree : 0.8e-3;
    for (Wave& wave : track_[e])  // two waves, together of that standard deviation along the track
      wave = {sigma * random_.normal(), random_.uniform(2.5, 5.0), random_.uniform(0.0, 2.0 * pi)};
  }
  V_L_ = draw_pose(2.0 * kDegree, 0.05);
  C_object_ = draw_pose(1.0, 0.05);
  object_T_ = draw_pose(1.0, 0.05);
  for (auto& axis : vicon_field_)
    for (Wave& wave : axis)
      wave = {0.3e-3 * std::sqrt(2.0 / 9.0) * random_.normal(), random_.uniform(1.5, 4.0),
              random_.uniform(0.0, 2.0 * pi)};
  const double focal = 1.0 + 3e-3 * random_.normal();
  lens_.fx_px *= focal;
  lens_.fy_px *= focal;
  lens_.cx_px += 4.0 * random_.normal();
  lens_.cy_px += 4.0 * random_.normal();
  for (double& k : lens_.distortion) k *= 1.0 + 0.03 * random_.normal();
}

Isometry3d SimulatedBench::flange(const Arm& arm, const Joints& stated) {
  Joints q = stated + arm.offset_rad;
  for (Eigen::Index k = 0; k < 6; ++k)
    q[k] += arm.gear_rad[k] * std::sin(arm.gear_periods[static_cast<std::size_t>(k)] * stated[k] + arm.gear_phase[k]);
  const ArmLengths& a = arm.lengths;
  // Horizontal distances of the wrist from A3 and A2.
  const double from_a3 = a.d4_m * std::cos(q[1] + q[2]) + a.a3_m * std::sin(q[1] + q[2]);
  const double from_a2 = from_a3 + a.a2_m * std::cos(q[1]);
  const double turned_a2 = q[1] + arm.gravity * arm.flex_rad_m[0] * from_a2;
  const double turned_a3 = q[2] + arm.gravity * arm.flex_rad_m[1] * from_a3;
  const Isometry3d wrist_flange(AngleAxisd(pi / 2.0, Vector3d::UnitY()));
  return Translation3d(0, 0, a.d1_m) * turn(-q[0], Vector3d::UnitZ()) * arm.link[0] * Translation3d(a.a1_m, 0, 0) *
         turn(turned_a2, Vector3d::UnitY()) * arm.link[1] * Translation3d(a.a2_m, 0, 0) *
         turn(turned_a3, Vector3d::UnitY()) * arm.link[2] * Translation3d(0, 0, a.a3_m) *
         turn(-q[3], Vector3d::UnitX()) * arm.link[3] * Translation3d(a.d4_m, 0, 0) * turn(q[4], Vector3d::UnitY()) *
         arm.link[4] * turn(-q[5], Vector3d::UnitX()) * Translation3d(a.d6_m, 0, 0) * wrist_flange;
}

Isometry3d SimulatedBench::T_L_C(const Posture& posture) const {
  const double x = posture.carriage_m;
  std::array<double, 5> error{};
  for (std::size_t e = 0; e < error.size(); ++e)
    for (const Wave& wave : track_[e]) error[e] += wave.at(x);
  // The carriage turns about the plate by which the arm hangs.
  const Translation3d plate(0.0, 0.0, bench_.camera_robot.base.position_m.z());
  const Isometry3d carriage = Translation3d(x + track_scale_ * (x - bench_.track.home_m), error[3], error[4]) * plate *
                              turn(error[2], Vector3d::UnitZ()) * turn(error[1], Vector3d::UnitY()) *
                              turn(error[0], Vector3d::UnitX()) * plate.inverse();
  return carriage * bench_.camera_robot.base.T_L_base() * flange(camera_, posture.camera_rad) * camera_.mount;
}

Isometry3d SimulatedBench::T_L_T(const Posture& posture) const {
  return target_base_ * flange(target_, posture.target_rad) * target_.mount;
}

Isometry3d SimulatedBench::by_vicon(const Isometry3d& T_V_object) {
  Isometry3d seen = T_V_object;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < 9; ++k)
      seen.translation()[static_cast<Eigen::Index>(axis)] +=
          vicon_field_[axis][k].at(T_V_object.translation()[static_cast<Eigen::Index>(k % 3)]);
  // The view's own error of rotation, and the noise of a mean of 20 frames.
  const double noise_rad = std::hypot(0.09, 0.02 / std::sqrt(20.0)) * kDegree;
  return seen * draw_pose(noise_rad, 0.05e-3 / std::sqrt(20.0));
}

Measurement SimulatedBench::measure(const Posture& commanded) {
  Measurement measurement;
  measurement.posture = commanded;
  Posture actual = commanded;  // repeatability: where the arms stand, the controllers do not see
  for (Eigen::Index k = 0; k < 6; ++k) {
    actual.camera_rad[k] += 0.0015 * kDegree * random_.normal();
    actual.target_rad[k] += 0.0015 * kDegree * random_.normal();
  }
  actual.carriage_m += 0.02e-3 * random_.normal();
  const Isometry3d L_C = T_L_C(actual), L_T = T_L_T(actual);
  measurement.true_T_C_T = L_C.inverse() * L_T;
  measurement.vicon = {by_vicon(V_L_ * L_C * C_object_), by_vicon(V_L_ * L_T * object_T_.inverse())};
  const double sigma = corner_sigma_px * (random_.uniform() < bad_share ? bad_factor : 1.0);
  for (int id = 0; id < board_.corner_count(); ++id) {
    const Vector3d point = *measurement.true_T_C_T * T_T_B_ * board_.corner(id);
    const fsw::Vector2 px = lens_.project(point) + sigma * fsw::Vector2(random_.normal(), random_.normal());
    if (px.x() < 5.0 || px.y() < 5.0 || px.x() > lens_.width_px - 6.0 || px.y() > lens_.height_px - 6.0) continue;
    measurement.corners.push_back({id, px});
  }
  return measurement;
}

}  // namespace vbar::tron::calibrate
