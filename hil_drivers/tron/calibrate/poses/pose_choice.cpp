#include "hil_drivers/tron/calibrate/poses/pose_choice.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/tron/calibrate/poses/reach.h"
#include "hil_drivers/tron/collision/bench_bodies.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using fsw::Vector3;
using std::numbers::pi;

constexpr int kTriesOfAPose = 4000;
constexpr double kImageMargin_px = 15.0;

/// Low-discrepancy sequence in one dimension (van der Corput, base 2).
double van_der_corput(int index) {
  double value = 0.0, digit = 1.0;
  for (int rest = index; rest > 0; rest /= 2) {
    digit /= 2.0;
    value += digit * (rest % 2);
  }
  return value;
}

Matrix3d about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
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
        reach_(bench, goals.limit_margin_rad) {}

  std::optional<Posture> choose(int index) {
    const double range_m = goals_.range_low_m + (goals_.range_high_m - goals_.range_low_m) * van_der_corput(index + 1);
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
    T_L_C.linear() = looking_along(sight) * about(Vector3::UnitZ(), pi * signed_uniform()) * off_centre();
    const double axis = pi * signed_uniform();
    const double tilt = std::acos(1.0 - (1.0 - std::cos(goals_.tilt_high_rad)) * random_.uniform());
    T_L_B.linear() = looking_along(sight) * about({std::cos(axis), std::sin(axis), 0.0}, tilt) *
                     about(Vector3::UnitZ(), pi * signed_uniform());
    if (!is_seen(T_L_C.inverse() * T_L_B)) return std::nullopt;
    const double carriage_m = T_L_C.translation().x() + goals_.carriage_ahead_m * signed_uniform();
    const auto posture = reach_.posture(T_L_C, T_L_B, carriage_m, random_);
    if (posture && filter_ && !filter_(*posture)) return std::nullopt;
    return posture;
  }

  double signed_uniform() { return random_.uniform(-1.0, 1.0); }

  /// Turns the boresight so that the board is anywhere in the image, more often near its edges: there the lens' centre
  /// and a turn of the camera differ most.
  Matrix3d off_centre() {
    const auto to_the_edge = [](double uniform) { return std::copysign(std::sqrt(std::abs(uniform)), uniform); };
    const double x = 0.43 * lens_.width_px / lens_.fx_px * to_the_edge(signed_uniform());
    const double y = 0.43 * lens_.height_px / lens_.fy_px * to_the_edge(signed_uniform());
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

  const BenchFile& bench_;
  const LensCalibration& lens_;
  const BoardDesign& board_;
  const PoseGoals& goals_;
  const PostureFilter& filter_;
  engine::RandomStream random_;
  Reach reach_;
};

}  // namespace

Matrix3d looking_along(const Vector3& z) {
  const Vector3 aside = std::abs(z.z()) < 0.99 ? Vector3(Vector3::UnitZ()) : Vector3(Vector3::UnitX());
  const Vector3 x = aside.cross(z).normalized();
  Matrix3d frame;
  frame << x, z.cross(x), z;
  return frame;
}

PostureFilter free_postures(const BenchFile& bench) {
  const auto bodies = std::make_shared<const BenchBodies>(bench);
  const double home_rad = bench.camera_robot.home_rad[3] + bench.camera_robot.home_rad[5];
  const double cable_rad = bench.motion.cable_turn_rad;
  return [bodies, home_rad, cable_rad](const Posture& posture) {
    return std::abs(posture.camera_rad[3] + posture.camera_rad[5] - home_rad) < cable_rad &&
           bodies->collision(bodies->at(posture)).empty();
  };
}

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
