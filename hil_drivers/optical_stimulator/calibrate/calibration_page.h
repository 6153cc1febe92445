#pragma once
// calibration.html: the figures of a calibration beside their goals, and the map of the residuals.

#include <string>

#include "hil_drivers/optical_stimulator/calibrate/procedure.h"

namespace vbar::optical_stimulator::calibrate {

[[nodiscard]] std::string calibration_page(const ProcedureResult& result);

}  // namespace vbar::optical_stimulator::calibrate
