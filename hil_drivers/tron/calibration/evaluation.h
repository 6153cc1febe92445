#pragma once
// Errors of calibrated poses at postures that were not fitted.

#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/pose_fusion.h"

namespace vbar::tron::calibrate {

enum class Source { kArms, kVicon, kFused };

struct PoseError {
  double translation_mm = 0.0, rotation_deg = 0.0;
  double pixel_px = 0.0;  ///< mean over the corners of the board
};

/// Holds the errors of one source at one posture.
struct EvaluatedPose {
  std::size_t measurement = 0;     ///< its index
  PoseError board;                 ///< against the pose by the image
  std::optional<PoseError> truth;  ///< error against the truth of an emulator
  double range_m = 0.0;
  FusionSources sources = FusionSources::kBoth;
  double chi_square = 0.0;  ///< set for kFused
};

/// Returns T_C_T of a source with a calibration; null without motion capture where the source needs it. `fused`: result
/// of the fusion.
[[nodiscard]] std::optional<Eigen::Isometry3d> pose_of_source(const Calibration& calibration, Source source,
                                                              const Measurement& measurement,
                                                              FusedPose* fused = nullptr);

/// Evaluates all measurements with a pose by the image.
[[nodiscard]] std::vector<EvaluatedPose> evaluate(const Calibration& calibration, Source source,
                                                  const BoardDesign& board, const Eigen::Isometry3d& T_target_board,
                                                  const std::vector<Measurement>& measurements);

[[nodiscard]] StageFigures figures_of(const std::string& stage, const std::vector<EvaluatedPose>& poses);

}  // namespace vbar::tron::calibrate
