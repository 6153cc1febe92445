#include "hil_drivers/tron/calibrate/procedure/check.h"

#include <algorithm>

#include <fmt/format.h>

#include "hil_drivers/tron/calibrate/procedure/procedure.h"

namespace vbar::tron::calibrate {
namespace {

constexpr int kMinPoses = 5;

/// Medians of the calibration's own fused poses; those of the paper where the file has none.
ErrorFigures reached(const Calibration& calibration) {
  for (const StageFigures& stage : calibration.figures)
    if (stage.stage == "fused") return stage.board;
  ErrorFigures paper;
  paper.translation_median_mm = 2.9;
  paper.rotation_median_deg = 0.35;
  paper.pixel_median_px = 2.0;
  return paper;
}

}  // namespace

CheckResult judge(const Calibration& calibration, const BenchFile& file, const std::vector<Measurement>& measurements) {
  CheckResult result;
  const ErrorFigures before = reached(calibration);
  result.translation_limit_mm = 2.0 * before.translation_median_mm + 1.0;
  result.rotation_limit_deg = 2.0 * before.rotation_median_deg + 0.1;
  result.pixel_limit_px = 2.0 * before.pixel_median_px + 0.5;
  std::vector<Measurement> ordered = measurements;
  for (Measurement& measurement : ordered) {
    if (!measurement.vicon) continue;
    const auto as_calibrated = [&](const Eigen::Isometry3d& pose) {
      return reordered(pose, file.vicon.rotation, calibration.vicon.rotation);
    };
    measurement.vicon =
        ViconObjects{as_calibrated(measurement.vicon->T_V_camera), as_calibrated(measurement.vicon->T_V_target)};
  }
  result.fused = evaluate(calibration, Source::kFused, BoardDesign{}, T_target_board(file), ordered);
  result.figures = figures_of("check", result.fused);
  result.beyond_gate = static_cast<int>(std::ranges::count_if(
      result.fused, [](const EvaluatedPose& pose) { return pose.sources == FusionSources::kArmsAlone; }));
  const ErrorFigures& now = result.figures.board;
  if (result.figures.poses < kMinPoses)
    result.reason = fmt::format("board and motion capture were seen at {} postures, {} are needed",
                                result.figures.poses, kMinPoses);
  else if (!(now.translation_median_mm <= result.translation_limit_mm))
    result.reason =
        fmt::format("translation {:.2f} mm, limit {:.2f} mm", now.translation_median_mm, result.translation_limit_mm);
  else if (!(now.rotation_median_deg <= result.rotation_limit_deg))
    result.reason =
        fmt::format("rotation {:.3f} deg, limit {:.3f} deg", now.rotation_median_deg, result.rotation_limit_deg);
  else if (!(now.pixel_median_px <= result.pixel_limit_px))
    result.reason = fmt::format("pixels {:.2f} px, limit {:.2f} px", now.pixel_median_px, result.pixel_limit_px);
  else if (4 * result.beyond_gate > result.figures.poses)
    result.reason =
        fmt::format("arms and motion capture disagree at {} of {} postures", result.beyond_gate, result.figures.poses);
  result.is_valid = result.reason.empty();
  return result;
}

CheckResult check(CalibrationBench& bench, const BenchFile& file, const Calibration& calibration, int poses,
                  std::uint64_t seed, const PostureFilter& filter, const Progress& progress) {
  const ProcedureSettings settings;
  const BoardDesign board;
  const auto postures = choose_postures(file, calibration.lens, board, poses, seed + 2'000'003, {}, filter);
  bench.mount(Mounted::kBoard);
  bench.light(board_lights(file, settings.lamp_azimuth_rad));
  double exposure_s = settings.exposure_s;
  std::vector<Measurement> measurements;
  for (const Posture& posture : postures)
    if (bench.move(posture)) measurements.push_back(measure_board(bench, board, exposure_s));
  bench.light({});
  bench.mount(Mounted::kTarget);
  if (progress) progress(fmt::format("{} of {} postures measured", measurements.size(), postures.size()));
  return judge(calibration, file, measurements);
}

}  // namespace vbar::tron::calibrate
