#include "hil_drivers/tron/imaging/image_exchange.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/tron/geometry/pose_fusion.h"

namespace vbar::tron {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
/// Below this irradiance relative to the Sun's the target is not lit: a white face would be a tenth of the read noise.
constexpr double kDark = 1e-5;

double angle_of(const fsw::Matrix3& rotation) {
  return std::abs(Eigen::AngleAxisd(rotation).angle());
}

/// Adds its life to a sum, s.
class WallTime {
 public:
  explicit WallTime(double& sum_s) : sum_s_(sum_s) {}
  ~WallTime() { sum_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  WallTime(const WallTime&) = delete;
  WallTime& operator=(const WallTime&) = delete;

 private:
  double& sum_s_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

void ImageExchange::set_lights(const LightLevels& levels) {
  laboratory_.light(levels);
  const double way_rad = lamp_azimuth_rad_ ? std::abs(levels.lamp_azimuth_rad - *lamp_azimuth_rad_) : std::numbers::pi;
  lamp_azimuth_rad_ = levels.lamp_azimuth_rad;
  lights_ready_s_ = laboratory_.time_s() + way_rad / settings_.lamp_speed_rad_s + settings_.lamp_delay_s;
}

/// False: interrupted.
bool ImageExchange::wait_for_lamp() {
  const double left_s = lights_ready_s_ - laboratory_.time_s();
  return left_s <= 0.0 || laboratory_.hold(left_s) == MotionEnd::kArrived;
}

/// False: interrupted, or without a path, which the row states.
bool ImageExchange::go_to(const Posture& posture, TronRow& row) {
  const auto path = [&] {
    const WallTime planning(row.plan_wall_s);
    return motion_.path(laboratory_.posture(), posture);
  }();
  if (const auto* const none = std::get_if<PlacementFailure>(&path)) {
    row.failure = none->reason;
    return false;
  }
  const WallTime moving(row.move_wall_s);
  const double begin_s = laboratory_.time_s();
  ++row.moves;
  const MotionEnd end = laboratory_.follow(std::get<Motion>(path));
  row.move_s += laboratory_.time_s() - begin_s;
  return end == MotionEnd::kArrived;
}

/// Nothing: interrupted.
std::optional<ImageExchange::Reached> ImageExchange::measure(const Scene& scene, TronRow& row) {
  const WallTime measuring(row.move_wall_s);
  const auto measured = laboratory_.measure();
  const auto* const found = std::get_if<MeasuredPlace>(&measured);
  if (found == nullptr) return std::nullopt;
  PoseEstimate arms{T_C_T_of_arms(calibration_, found->posture)};
  arms.covariance = covariance_at(calibration_.covariance.arms, arms.T);
  FusedPose fused{arms, 0.0, FusionSources::kArmsAlone};
  row.disagreement.reset();
  if (found->capture) {
    PoseEstimate vicon{T_C_T_of_vicon(calibration_, found->capture->T_V_camera, found->capture->T_V_target)};
    vicon.covariance = covariance_at(calibration_.covariance.vicon, vicon.T);
    fused = fuse(arms, vicon);
    row.disagreement = fused.chi_square;
    // The errors of motion capture vary slowly with place and attitude: just beyond the gate, images in a row are no
    // sign of a fault.
    disagreements_ = fused.chi_square <= settings_.slipped_chi_square ? 0 : disagreements_ + 1;
    if (disagreements_ >= settings_.disagreements_in_row)
      throw std::runtime_error(fmt::format(
          "arms and motion capture disagree in {} successive images (chi-square {:.0f}, accepted {:.1f}): a mount has "
          "slipped, or the calibration is not of this bench",
          disagreements_, fused.chi_square, settings_.slipped_chi_square));
  }
  row.pose_source = fused.sources == FusionSources::kBoth ? "fused" : "arms";
  const Eigen::Isometry3d difference = scene.T_C_T.inverse() * fused.pose.T;
  return Reached{fused.pose.T, found->posture, {difference.translation().norm(), angle_of(difference.linear())}};
}

/// The arms at the scene, measured and corrected. Nothing: interrupted, or the row states why.
std::optional<ImageExchange::Reached> ImageExchange::reach(const Scene& scene, std::int64_t number, TronRow& row,
                                                           Place& place) {
  const auto placed = [&] {
    const WallTime planning(row.plan_wall_s);
    return motion_.place(scene, laboratory_.posture(), number);
  }();
  if (const auto* const none = std::get_if<PlacementFailure>(&placed)) {
    row.failure = none->reason;
    return std::nullopt;
  }
  place = std::get<Place>(placed);
  row.hidden = place.hidden;
  row.shaded = place.shaded;
  row.lamp_azimuth_deg = place.lamp_azimuth_rad / kDegree;
  row.sun_error_deg = place.sun_error_rad / kDegree;
  const LightLevels levels = lights_.levels(scene, place);
  row.lamp_power = levels.lamp_power;
  row.earth_light_misfit = levels.earth_misfit;
  set_lights(levels);

  const auto begin = motion_.corrected(place.posture, scene.T_C_T);
  if (!begin) {
    row.failure = "the calibrated arms do not reach the pose of the placement";
    return std::nullopt;
  }
  if (!go_to(*begin, row)) return std::nullopt;
  auto reached = measure(scene, row);
  if (!reached) return std::nullopt;
  row.first_error_mm = 1e3 * reached->error.translation_m;
  row.first_error_deg = reached->error.rotation_rad / kDegree;
  if (reached->error.translation_m <= settings_.correct_above_m &&
      reached->error.rotation_rad <= settings_.correct_above_rad)
    return reached;
  // What the measured pose is off from that by the arms stays as it is while they move by a millimetre.
  const Eigen::Isometry3d T_C_T_arms = T_C_T_of_arms(calibration_, reached->posture);
  const auto better = motion_.corrected(reached->posture, scene.T_C_T * reached->T_C_T.inverse() * T_C_T_arms);
  if (!better) return reached;  // at a limit of an axis; whether it is good enough is judged below
  if (!go_to(*better, row)) return std::nullopt;
  return measure(scene, row);
}

SceneImage ImageExchange::take(const Scene& scene, std::int64_t number, double exposure_s, TronRow& row) {
  const double begin_s = laboratory_.time_s();
  SceneImage image;
  image.is_lit = scene.sunlit > kDark || scene.earth_to_sun > kDark;
  if (!image.is_lit) {
    DetectorFrame frame = take_dark(exposure_s);
    row.tries = frame.tries;
    row.packets_resent = frame.packets_resent;
    image.dn = std::move(frame.dn);
    row.bench_s = laboratory_.time_s() - begin_s;
    return image;
  }
  for (int interruptions = 0;; ++interruptions) {
    Place place;
    const auto reached = reach(scene, number, row, place);
    row.bench_s = laboratory_.time_s() - begin_s;
    if (!row.failure.empty()) return image;
    if (reached && wait_for_lamp()) {
      row.pose_error_mm = 1e3 * reached->error.translation_m;
      row.pose_error_deg = reached->error.rotation_rad / kDegree;
      if (reached->error.translation_m > settings_.fail_above_m ||
          reached->error.rotation_rad > settings_.fail_above_rad) {
        row.failure = "the pose after correction is too far from the commanded one";
        return image;
      }
      image.T_C_T = reached->T_C_T;
      break;
    }
    if (interruptions >= settings_.restarts_in_row)
      throw std::runtime_error(fmt::format("robots: image {} was interrupted {} times", number, interruptions + 1));
    laboratory_.recover();
  }
  DetectorFrame frame = laboratory_.take(exposure_s);
  row.tries = frame.tries;
  row.packets_resent = frame.packets_resent;
  row.bench_s = laboratory_.time_s() - begin_s;
  image.dn = std::move(frame.dn);
  return image;
}

DetectorFrame ImageExchange::take_dark(double exposure_s) {
  LightLevels off;
  if (lamp_azimuth_rad_) off.lamp_azimuth_rad = *lamp_azimuth_rad_;
  set_lights(off);
  if (!wait_for_lamp()) {
    laboratory_.recover();
  }
  return laboratory_.take(exposure_s);
}

}  // namespace vbar::tron
