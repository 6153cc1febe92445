#pragma once
// Complete calibration, step by step.

#include "hil_drivers/optical_stimulator/calibrate/session.h"

namespace vbar::optical_stimulator::calibrate {

struct ProcedureResult {
  BenchCalibration calibration;
  std::vector<Residual> residuals;  ///< dots held out, for the heat map
};

/// Calibrates: rails home; noise; focus; gain; counts to light; geometry; dots held out. It fills the measured parts of
/// the validity: rails, display, region and exposure. Throws std::runtime_error with one sentence if a step fails; a
/// geometry that misses its goal is a result (held_out.goal_reached).
[[nodiscard]] ProcedureResult calibrate(const Bench& bench, const ProcedureSettings& settings,
                                        Session::Progress progress);

}  // namespace vbar::optical_stimulator::calibrate
