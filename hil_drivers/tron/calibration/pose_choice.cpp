#include "hil_drivers/tron/calibration/pose_choice.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil_drivers/tron/geometry/collision.h"
#include "hil_drivers/tron/lights/photometry.h"

namespace vbar::tron::calibrate {

Reach::Reach(const TestbedDesign& bench, double limit_margin_rad)
    : arms_(bench),
      track_(bench.track.axis),
      limit_margin_rad_(limit_margin_rad),
      T_B_T_(T_target_board(bench).inverse()) {}

std::optional<Posture> Reach::posture(const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_B, double carriage_m,
                                      engine::RandomStream& random) const {
  if (carriage_m < track_.lower || carriage_m > track_.upper) return std::nullopt;
  const auto camera = joints(arms_.camera_arm(), arms_.camera_flange(T_L_C, carriage_m), random);
  if (!camera) return std::nullopt;
  const auto target = joints(arms_.target_arm(), arms_.target_flange(T_L_B * T_B_T_), random);
  if (!target) return std::nullopt;
  return Posture{*camera, *target, carriage_m};
}

std::optional<Joints> Reach::joints(const Arm& arm, const Eigen::Isometry3d& T_base_flange,
                                    engine::RandomStream& random) const {
  const Branches branches = arm.inverse(T_base_flange);
  std::vector<Joints> possible;
  for (std::size_t branch = 0; branch < branches.count; ++branch) {
    if (!branches.is_within_limits[branch]) continue;
    const Joints& joints = branches.joints[branch];
    bool is_clear = true;
    for (std::size_t k = 0; k < kJoints; ++k) {
      const double joint = joints[static_cast<Eigen::Index>(k)];
      const AxisLimits& axis = arm.design().axes[k];
      is_clear = is_clear && joint > axis.lower + limit_margin_rad_ && joint < axis.upper - limit_margin_rad_;
    }
    if (is_clear) possible.push_back(joints);
  }
  if (possible.empty()) return std::nullopt;
  const auto count = static_cast<double>(possible.size());
  return possible[std::min(possible.size() - 1, static_cast<std::size_t>(count * random.uniform()))];
}

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
  Chooser(const TestbedDesign& bench, const LensCalibration& lens, const BoardDesign& board, std::uint64_t seed,
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

  const TestbedDesign& bench_;
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

PostureFilter free_postures(const TestbedDesign& bench) {
  const auto bodies = std::make_shared<const TestbedBodies>(bench);
  const double home_rad = bench.camera_robot.home_rad[3] + bench.camera_robot.home_rad[5];
  const double cable_rad = bench.motion.cable_turn_rad;
  return [bodies, home_rad, cable_rad](const Posture& posture) {
    return std::abs(posture.camera_rad[3] + posture.camera_rad[5] - home_rad) < cable_rad &&
           bodies->collision(bodies->at(posture)).empty();
  };
}

std::vector<Posture> choose_postures(const TestbedDesign& bench, const LensCalibration& lens, const BoardDesign& board,
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

namespace {

constexpr int kTries = 60000;
constexpr double kLimitMargin_rad = 0.05;
/// Share of the irradiance that a source gives to an area there that faces it: wanted first, and at last.
constexpr std::array kWanted{0.6, 0.35, 0.15};

class PatchChooser {
 public:
  PatchChooser(const TestbedDesign& bench, const LensCalibration& lens, const BoardDesign& board,
               double lamp_azimuth_rad, std::uint64_t seed, const PostureFilter& filter, const SourceFlags& measured)
      : bench_(bench),
        lens_(lens),
        board_(board),
        lamp_(Lamp::direction(lamp_azimuth_rad)),
        filter_(filter),
        random_(seed, "tron/calibrate/patch"),
        reach_(bench, kLimitMargin_rad),
        covered_(measured) {
    for (const Vector3& corner : board.patch()) patch_B_ += 0.25 * corner;
  }

  std::vector<PatchPosture> choose() {
    std::vector<PatchPosture> chosen;
    for (const double wanted : kWanted)
      for (int k = 0; k < kTries && !is_complete(); ++k)
        if (auto posture = attempt(wanted)) chosen.push_back(*posture);
    if (is_complete()) return chosen;
    std::string missing;
    for (std::size_t k = 0; k < kLightSources; ++k)
      if (!covered_[k]) missing += (missing.empty() ? "" : ", ") + light_source_name(k);
    throw std::runtime_error(fmt::format(
        "{}: no posture found at which the camera sees the white patch in the light of {}", bench_.name, missing));
  }

 private:
  [[nodiscard]] bool is_complete() const {
    return std::ranges::all_of(covered_, [](bool covered) { return covered; });
  }

  std::optional<PatchPosture> attempt(double wanted) {
    const Vector3 spread(signed_uniform(), signed_uniform(), signed_uniform());
    const Vector3 place = bench_.lamp.centre_m + 0.25 * spread;
    const Vector3 normal = direction();
    PatchPosture result;
    result.lights = new_lights(place, normal, wanted);
    if (result.lights.empty()) return std::nullopt;
    const Vector3 to_camera = direction();
    if (to_camera.dot(normal) < 0.45) return std::nullopt;
    const double range_m = random_.uniform(0.7, 2.5);
    Isometry3d T_L_C = Isometry3d::Identity(), T_L_B = Isometry3d::Identity();
    T_L_C.translation() = place + range_m * to_camera;
    if (!(T_L_C.translation().array() > bench_.room_low_m.array() + 0.3).all() ||
        !(T_L_C.translation().array() < bench_.room_high_m.array() - 0.3).all())
      return std::nullopt;
    T_L_C.linear() = turned(looking_along(-to_camera));
    T_L_B.linear() = turned(looking_along(-normal));
    T_L_B.translation() = place - T_L_B.linear() * patch_B_;
    if (!is_seen(T_L_C.inverse() * T_L_B)) return std::nullopt;
    const auto posture = reach_.posture(T_L_C, T_L_B, place_of_carriage(T_L_C), random_);
    if (!posture || (filter_ && !filter_(*posture))) return std::nullopt;
    result.posture = *posture;
    for (const PatchPosture::Light& light : result.lights) covered_[light.source] = true;
    return result;
  }

  double place_of_carriage(const Isometry3d& T_L_C) {
    const AxisLimits& axis = bench_.track.axis;
    return std::clamp(T_L_C.translation().x() + 0.9 * signed_uniform(), axis.lower, axis.upper);
  }

  double signed_uniform() { return random_.uniform(-1.0, 1.0); }

  Vector3 direction() {
    const double z = signed_uniform(), angle = pi * signed_uniform(), r = std::sqrt(1.0 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  Eigen::Matrix3d turned(const Eigen::Matrix3d& frame) {
    return frame * Eigen::AngleAxisd(pi * signed_uniform(), Vector3::UnitZ()).toRotationMatrix();
  }

  /// Sources not yet covered that light an area there well enough.
  [[nodiscard]] std::vector<PatchPosture::Light> new_lights(const Vector3& place, const Vector3& normal,
                                                            double wanted) const {
    std::vector<PatchPosture::Light> lights;
    if (!covered_[0] && normal.dot(lamp_) >= wanted) lights.push_back({0, normal.dot(lamp_)});
    for (std::size_t k = 0; k < kBoxes; ++k) {
      if (covered_[1 + k]) continue;
      const Vector3 facing = (bench_.boxes.boxes[k].centre_m - place).normalized();
      if (normal.dot(facing) < wanted) continue;
      const auto corners = corners_of(bench_.boxes.boxes[k]);
      lights.push_back({1 + k, bench_.boxes.exitance_ratio * form_factor(place, normal, corners)});
    }
    return lights;
  }

  [[nodiscard]] std::array<Vector3, 4> corners_of(const LightBox& box) const {
    const Eigen::Matrix3d frame = looking_along(box.normal);
    const double half = 0.5 * bench_.boxes.side_m;
    std::array<Vector3, 4> corners;
    constexpr std::array<std::array<double, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (std::size_t k = 0; k < 4; ++k)
      corners[k] = box.centre_m + half * (kSigns[k][0] * frame.col(0) + kSigns[k][1] * frame.col(1));
    return corners;
  }

  [[nodiscard]] bool is_seen(const Isometry3d& T_C_B) const {
    return std::ranges::all_of(board_.patch(), [&](const Vector3& corner) {
      const Vector3 point = T_C_B * corner;
      if (point.z() < 0.3) return false;
      const fsw::Vector2 px = lens_.project(point);
      return px.x() > kImageMargin_px && px.y() > kImageMargin_px && px.x() < lens_.width_px - 1 - kImageMargin_px &&
             px.y() < lens_.height_px - 1 - kImageMargin_px;
    });
  }

  const TestbedDesign& bench_;
  const LensCalibration& lens_;
  const BoardDesign& board_;
  Vector3 lamp_;
  const PostureFilter& filter_;
  engine::RandomStream random_;
  Reach reach_;
  Vector3 patch_B_ = Vector3::Zero();
  SourceFlags covered_;
};

}  // namespace

std::vector<PatchPosture> choose_patch_postures(const TestbedDesign& bench, const LensCalibration& lens,
                                                const BoardDesign& board, double lamp_azimuth_rad, std::uint64_t seed,
                                                const PostureFilter& filter, const SourceFlags& measured) {
  return PatchChooser(bench, lens, board, lamp_azimuth_rad, seed, filter, measured).choose();
}

}  // namespace vbar::tron::calibrate
