#include "hil_drivers/tron/calibrate/poses/patch_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "hil_drivers/tron/calibrate/poses/reach.h"
#include "hil_drivers/tron/lights/form_factor.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using fsw::Vector3;
using std::numbers::pi;

constexpr int kTries = 60000;
constexpr double kLimitMargin_rad = 0.05, kImageMargin_px = 15.0;
/// Share of the irradiance that a source gives to an area there that faces it: wanted first, and at last.
constexpr std::array kWanted{0.6, 0.35, 0.15};

class PatchChooser {
 public:
  PatchChooser(const BenchFile& bench, const LensCalibration& lens, const BoardDesign& board, double lamp_azimuth_rad,
               std::uint64_t seed, const PostureFilter& filter, const SourceFlags& measured)
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

  const BenchFile& bench_;
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

std::vector<PatchPosture> choose_patch_postures(const BenchFile& bench, const LensCalibration& lens,
                                                const BoardDesign& board, double lamp_azimuth_rad, std::uint64_t seed,
                                                const PostureFilter& filter, const SourceFlags& measured) {
  return PatchChooser(bench, lens, board, lamp_azimuth_rad, seed, filter, measured).choose();
}

}  // namespace vbar::tron::calibrate
