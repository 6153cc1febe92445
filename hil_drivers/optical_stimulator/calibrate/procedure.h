#pragma once
// A complete calibration, step by step.

#include "hil_drivers/optical_stimulator/calibrate/session.h"

namespace vbar::optical_stimulator::calibrate {

struct ProcedureResult {
  BenchCalibration calibration;
  std::vector<Residual> residuals;  ///< dots held out, for the heat map
};

/// Rails home; noise; focus; gain; counts to light; geometry; dots held out. Of the validity it fills what it measured:
/// rails, display, region and exposure. Throws std::runtime_error with one sentence if a step fails; a geometry that
/// misses its goal is a result (held_out.goal_reached).
[[nodiscard]] ProcedureResult calibrate(const Bench& bench, const ProcedureSettings& settings,
                                        Session::Progress progress);

}  // namespace vbar::optical_stimulator::calibrate
