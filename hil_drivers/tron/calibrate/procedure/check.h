#pragma once
// Check of a calibration: a few postures measured once more.

#include <string>
#include <vector>

#include "hil_drivers/tron/calibrate/poses/pose_choice.h"
#include "hil_drivers/tron/calibrate/procedure/calibration_bench.h"
#include "hil_drivers/tron/calibrate/stages/fit_bench.h"

namespace vbar::tron::calibrate {

struct CheckResult {
  std::vector<EvaluatedPose> fused;
  double translation_limit_mm = 0.0, rotation_limit_deg = 0.0, pixel_limit_px = 0.0;  ///< limits of the medians
  StageFigures figures;
  int beyond_gate = 0;  ///< postures at which arms and motion capture disagree
  bool is_valid = false;
  std::string reason;  ///< description of the first limit that is exceeded
};

/// Judges measurements: medians of the fused pose against the board, at most twice those of the calibration and 1 mm,
/// 0.1 deg and 0.5 px more, and at most a quarter of the postures beyond fusion's gate.
[[nodiscard]] CheckResult judge(const Calibration& calibration, const BenchFile& file,
                                const std::vector<Measurement>& measurements);

/// Measures at `poses` postures and judges.
[[nodiscard]] CheckResult check(CalibrationBench& bench, const BenchFile& file, const Calibration& calibration,
                                int poses, std::uint64_t seed, const PostureFilter& filter, const Progress& progress);

}  // namespace vbar::tron::calibrate
