#pragma once
// Light of the sources at levels of their values, and the camera without light.

#include <vector>

#include "hil_drivers/tron/calibrate/data/calibration_data.h"
#include "hil_drivers/tron/calibrate/poses/patch_choice.h"
#include "hil_drivers/tron/calibrate/procedure/calibration_bench.h"

namespace vbar::tron::calibrate {

/// Returns the mean and, from differences of successive images, the noise of a pixel in images with all lights off.
[[nodiscard]] DarkFigures measure_dark(CalibrationBench& bench, double exposure_s, int images = 4);

/// Measures each source alone at `levels` levels up to the full one. A posture to which there is no way is left out.
[[nodiscard]] std::vector<LightSample> measure_lights(CalibrationBench& bench, const LensCalibration& lens,
                                                      const BenchFile& file, const BoardDesign& board,
                                                      const std::vector<PatchPosture>& postures,
                                                      double lamp_azimuth_rad, int levels);

/// Returns the sources that have samples.
[[nodiscard]] SourceFlags measured_sources(const std::vector<LightSample>& samples);

/// Returns the light relative to full power as designed, for the lamp relative to its own full power. A level at which
/// the light does not rise above that of the level before is left out.
[[nodiscard]] std::vector<LightTable> light_tables(const std::vector<LightSample>& samples);

/// Returns the level of the lamp at full power on the white patch facing it, DN per second; 0 if it was not measured.
[[nodiscard]] double lamp_dn_per_s(const std::vector<LightSample>& samples);

}  // namespace vbar::tron::calibrate
