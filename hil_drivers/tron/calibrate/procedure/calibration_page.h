#pragma once
// A calibration as one HTML page.

#include <string>

#include "hil_drivers/tron/calibrate/data/calibration_data.h"
#include "hil_drivers/tron/calibrate/stages/fit_bench.h"

namespace vbar::tron::calibrate {

[[nodiscard]] std::string calibration_page(const BenchFit& fit, const CalibrationData& data);

}  // namespace vbar::tron::calibrate
