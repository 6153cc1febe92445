#include "hil_drivers/tron/calibration/evaluation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "hil_drivers/tron/calibration/pose_estimation.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;

constexpr double kDegree = std::numbers::pi / 180.0;

PoseError error_of(const Isometry3d& estimate, const Isometry3d& reference) {
  PoseError error;
  error.translation_mm = 1e3 * (estimate.translation() - reference.translation()).norm();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(estimate.linear().transpose() * reference.linear()));
  error.rotation_deg = turn.angle() / kDegree;
  return error;
}

struct Moments {
  double mean = 0.0, sigma = 0.0, median = 0.0;
};

Moments moments_of(std::vector<double> values) {
  Moments moments;
  if (values.empty()) return moments;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) moments.mean += value / count;
  for (const double value : values) moments.sigma += (value - moments.mean) * (value - moments.mean);
  moments.sigma = std::sqrt(moments.sigma / std::max(1.0, count - 1.0));
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  moments.median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return moments;
}

ErrorFigures errors_of(const std::vector<PoseError>& errors) {
  const auto moments = [&](double PoseError::*member) {
    std::vector<double> values;
    for (const PoseError& error : errors) values.push_back(error.*member);
    return moments_of(values);
  };
  const Moments t = moments(&PoseError::translation_mm), r = moments(&PoseError::rotation_deg),
                p = moments(&PoseError::pixel_px);
  return {t.mean, t.sigma, t.median, r.mean, r.sigma, r.median, p.mean, p.sigma, p.median};
}

}  // namespace

std::optional<Isometry3d> pose_of_source(const Calibration& calibration, Source source, const Measurement& measurement,
                                         FusedPose* fused) {
  const Isometry3d by_arms = T_C_T_of_arms(calibration, measurement.posture);
  if (source == Source::kArms) return by_arms;
  if (!measurement.vicon) return std::nullopt;
  const Isometry3d by_vicon = T_C_T_of_vicon(calibration, measurement.vicon->T_V_camera, measurement.vicon->T_V_target);
  if (source == Source::kVicon) return by_vicon;
  const FusedPose both = fuse({by_arms, covariance_at(calibration.covariance.arms, by_arms)},
                              {by_vicon, covariance_at(calibration.covariance.vicon, by_vicon)});
  if (fused != nullptr) *fused = both;
  return both.pose.T;
}

std::vector<EvaluatedPose> evaluate(const Calibration& calibration, Source source, const BoardDesign& board,
                                    const Isometry3d& T_target_board, const std::vector<Measurement>& measurements) {
  std::vector<EvaluatedPose> poses;
  for (std::size_t k = 0; k < measurements.size(); ++k) {
    const Measurement& measurement = measurements[k];
    FusedPose fused;
    const auto estimate = pose_of_source(calibration, source, measurement, &fused);
    if (!estimate) continue;
    const auto seen = board_pose(board, calibration.lens, measurement.corners, *estimate * T_target_board);
    if (!seen) continue;
    EvaluatedPose pose;
    pose.measurement = k;
    pose.range_m = estimate->translation().norm();
    pose.sources = fused.sources;
    pose.chi_square = fused.chi_square;
    pose.board = error_of(*estimate, seen->T_C_B * T_target_board.inverse());
    const auto pixel_of = [&](const Isometry3d& T_C_T, int id) {
      return calibration.lens.project(T_C_T * T_target_board * board.corner(id));
    };
    const auto count = static_cast<double>(measurement.corners.size());
    for (const Corner& corner : measurement.corners)
      pose.board.pixel_px += (pixel_of(*estimate, corner.id) - corner.px).norm() / count;
    if (measurement.true_T_C_T) {
      pose.truth = error_of(*estimate, *measurement.true_T_C_T);
      for (const Corner& corner : measurement.corners)
        pose.truth->pixel_px +=
            (pixel_of(*estimate, corner.id) - pixel_of(*measurement.true_T_C_T, corner.id)).norm() / count;
    }
    poses.push_back(pose);
  }
  return poses;
}

StageFigures figures_of(const std::string& stage, const std::vector<EvaluatedPose>& poses) {
  StageFigures figures;
  figures.stage = stage;
  figures.poses = static_cast<int>(poses.size());
  std::vector<PoseError> board, truth;
  for (const EvaluatedPose& pose : poses) {
    board.push_back(pose.board);
    if (pose.truth) truth.push_back(*pose.truth);
  }
  figures.board = errors_of(board);
  if (!truth.empty() && truth.size() == board.size()) figures.truth = errors_of(truth);
  return figures;
}

}  // namespace vbar::tron::calibrate
