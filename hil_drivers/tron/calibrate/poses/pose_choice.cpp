#include "hil_drivers/tron/calibrate/poses/pose_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using fsw::Vector3;
using std::numbers::pi;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kTriesOfAPose = 400, kStarts = 12, kIterations = 25;
constexpr double kImageMargin_px = 15.0;

/// Low-discrepancy sequence in one dimension (van der Corput, base b).
double van_der_corput(int index, int base) {
  double value = 0.0, digit = 1.0;
  for (int rest = index; rest > 0; rest /= base) {
    digit /= base;
    value += digit * (rest % base);
  }
  return value;
}

Matrix3d frame_about(const Vector3& z) {
  const Vector3 x = Vector3::UnitZ().cross(z).normalized();
  Matrix3d frame;
  frame << x, z.cross(x), z;
  return frame;
}

class Chooser {
 public:
  Chooser(const BenchFile& bench, const LensCalibration& lens, const BoardDesign& board, std::uint64_t seed,
          const PoseGoals& goals, const PostureFilter& filter)
      : bench_(bench),
        lens_(lens),
        board_(board),
        goals_(goals),
        filter_(filter),
        random_(seed, "tron/calibrate/poses"),
        design_(calibration_as_designed(bench)),
        T_T_B_(T_target_board(bench)) {}

  std::optional<Posture> choose(int index) {
    const double range_m =
        goals_.range_low_m + (goals_.range_high_m - goals_.range_low_m) * van_der_corput(index + 1, 2);
    for (int k = 0; k < kTriesOfAPose; ++k)
      if (const auto posture = attempt(range_m)) return posture;
    return std::nullopt;
  }

 private:
  std::optional<Posture> attempt(double range_m) {
    const Vector3 spread(signed_uniform(), signed_uniform(), signed_uniform());
    Isometry3d T_L_B = Isometry3d::Identity();
    T_L_B.translation() = bench_.lamp.centre_m + goals_.target_spread_m * spread;
    const double yaw = goals_.yaw_high_rad * signed_uniform(), pitch = goals_.pitch_high_rad * signed_uniform();
    // From the camera to the board.
    const Vector3 sight(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch));
    Isometry3d T_L_C = Isometry3d::Identity();
    T_L_C.translation() = T_L_B.translation() - range_m * sight;
    T_L_C.linear() = frame_about(sight) * about(Vector3::UnitZ(), pi * signed_uniform()) * off_centre();
    const Matrix3d facing = frame_about(sight);
    const double axis = pi * signed_uniform();
    const double tilt = std::acos(1.0 - (1.0 - std::cos(goals_.tilt_high_rad)) * random_.uniform());
    T_L_B.linear() =
        facing * about({std::cos(axis), std::sin(axis), 0.0}, tilt) * about(Vector3::UnitZ(), pi * signed_uniform());
    if (!is_seen(T_L_C.inverse() * T_L_B)) return std::nullopt;
    Posture posture;
    posture.carriage_m = T_L_C.translation().x() + goals_.carriage_ahead_m * signed_uniform();
    const AxisLimits& track = bench_.track.axis;
    if (posture.carriage_m < track.lower || posture.carriage_m > track.upper) return std::nullopt;
    const Isometry3d T_carriage =
        Eigen::Translation3d(posture.carriage_m, 0.0, 0.0) * bench_.camera_robot.base.T_L_base();
    const auto camera = joints_of(bench_.camera_robot.design, design_.camera_arm, T_carriage.inverse() * T_L_C);
    if (!camera) return std::nullopt;
    posture.camera_rad = *camera;
    const auto target = joints_of(bench_.target_robot.design, design_.target_arm,
                                  bench_.target_robot.base.T_L_base().inverse() * T_L_B * T_T_B_.inverse());
    if (!target) return std::nullopt;
    posture.target_rad = *target;
    if (filter_ && !filter_(posture)) return std::nullopt;
    return posture;
  }

  double signed_uniform() { return random_.uniform(-1.0, 1.0); }

  static Matrix3d about(const Vector3& axis, double angle) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

  /// Turns the boresight so that the board is anywhere in the image.
  Matrix3d off_centre() {
    const double x = 0.40 * lens_.width_px / lens_.fx_px * signed_uniform();
    const double y = 0.40 * lens_.height_px / lens_.fy_px * signed_uniform();
    return Eigen::Quaterniond::FromTwoVectors(Vector3(x, y, 1.0), Vector3::UnitZ()).toRotationMatrix();
  }

  [[nodiscard]] bool is_seen(const Isometry3d& T_C_B) const {
    int seen = 0;
    for (int id = 0; id < board_.corner_count(); ++id) {
      const Vector3 point = T_C_B * board_.corner(id);
      if (point.z() < 0.3) return false;
      const fsw::Vector2 px = lens_.project(point);
      if (px.x() > kImageMargin_px && px.y() > kImageMargin_px && px.x() < lens_.width_px - 1 - kImageMargin_px &&
          px.y() < lens_.height_px - 1 - kImageMargin_px)
        ++seen;
    }
    return seen >= goals_.share_in_image * board_.corner_count();
  }

  /// Newton's method from random joints.
  std::optional<Joints> joints_of(const ArmDesign& design, const ArmCalibration& arm, const Isometry3d& T_base_tool) {
    const Isometry3d goal = T_base_tool * arm.mount.isometry().inverse();
    if ((goal.translation() - Vector3(0.0, 0.0, design.d1_m)).norm() >
        design.a1_m + design.a2_m + design.a3_m + design.d4_m + design.d6_m)
      return std::nullopt;
    for (int k = 0; k < kStarts; ++k) {
      Joints joints;
      for (std::size_t j = 0; j < kJoints; ++j)
        joints[static_cast<Eigen::Index>(j)] =
            random_.uniform(design.axes[j].lower, design.axes[j].upper) * (j == 5 ? 0.5 : 1.0);
      if (solve(arm, goal, joints) && is_within(design, joints)) return joints;
    }
    return std::nullopt;
  }

  static Vector6 miss_of(const ArmCalibration& arm, const Isometry3d& goal, const Joints& joints) {
    const Isometry3d T = T_base_flange<double>(arm.lengths, joints.data(), 1.0,
                                               {arm.offset_rad.data(), arm.link.front().data(), arm.flex_rad_m.data()});
    const Eigen::AngleAxisd turn(Matrix3d(goal.linear() * T.linear().transpose()));
    Vector6 miss;
    miss << turn.angle() * turn.axis(), goal.translation() - T.translation();
    return miss;
  }

  static bool solve(const ArmCalibration& arm, const Isometry3d& goal, Joints& joints) {
    constexpr double kStep = 1e-6;
    Vector6 miss = miss_of(arm, goal, joints);
    for (int k = 0; k < kIterations; ++k) {
      Matrix6 jacobian;
      for (int j = 0; j < 6; ++j) {
        Joints moved = joints;
        moved[j] += kStep;
        jacobian.col(j) = (miss - miss_of(arm, goal, moved)) / kStep;
      }
      Matrix6 normal = jacobian.transpose() * jacobian;
      normal.diagonal().array() += 1e-4 * std::min(1.0, miss.squaredNorm());
      Vector6 step = normal.ldlt().solve(jacobian.transpose() * miss);
      const double largest = step.cwiseAbs().maxCoeff();
      if (!std::isfinite(largest)) return false;
      if (largest > 0.6) step *= 0.6 / largest;
      joints += step;
      miss = miss_of(arm, goal, joints);
      if (miss.norm() < 1e-9) return true;
    }
    return false;
  }

  /// Whole turns are taken off first.
  bool is_within(const ArmDesign& design, Joints& joints) const {
    for (std::size_t k = 0; k < kJoints; ++k) {
      double& joint = joints[static_cast<Eigen::Index>(k)];
      const double low = design.axes[k].lower + goals_.limit_margin_rad,
                   high = design.axes[k].upper - goals_.limit_margin_rad;
      joint = std::remainder(joint, 2.0 * pi);
      if (joint < low) joint += 2.0 * pi;
      if (joint > high) joint -= 2.0 * pi;
      if (joint < low || joint > high) return false;
    }
    return true;
  }

  const BenchFile& bench_;
  const LensCalibration& lens_;
  const BoardDesign& board_;
  const PoseGoals& goals_;
  const PostureFilter& filter_;
  engine::RandomStream random_;
  Calibration design_;
  Isometry3d T_T_B_;
};

}  // namespace

std::vector<Posture> choose_postures(const BenchFile& bench, const LensCalibration& lens, const BoardDesign& board,
                                     int count, std::uint64_t seed, const PoseGoals& goals,
                                     const PostureFilter& filter) {
  Chooser chooser(bench, lens, board, seed, goals, filter);
  std::vector<Posture> postures;
  int failed = 0;
  for (int index = 0; static_cast<int>(postures.size()) < count; ++index) {
    if (const auto posture = chooser.choose(index))
      postures.push_back(*posture);
    else if (++failed > count)
      throw std::runtime_error(
          fmt::format("{}: only {} of {} postures found at which the camera sees the calibration board", bench.name,
                      postures.size(), count));
  }
  std::ranges::stable_sort(postures, {}, &Posture::carriage_m);
  return postures;
}

}  // namespace vbar::tron::calibrate
