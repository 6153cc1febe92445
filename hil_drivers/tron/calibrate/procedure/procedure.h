#pragma once
// A calibration from the first posture to the file.

#include "hil_drivers/tron/calibrate/data/calibration_data.h"
#include "hil_drivers/tron/calibrate/poses/pose_choice.h"
#include "hil_drivers/tron/calibrate/procedure/calibration_bench.h"
#include "hil_drivers/tron/calibrate/stages/fit_bench.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::calibrate {

struct ProcedureSettings {
  int fitted = 208, judged = 110;
  int light_levels = 8;  ///< levels of a source; 0: lights and camera are not measured
  std::uint64_t seed = 1;
  double exposure_s = 2e-3;  ///< where the search for the board's exposure begins
  double lamp_azimuth_rad = 1.2;
};
/// Returns settings with fewer postures, for a test of the whole path.
[[nodiscard]] ProcedureSettings quick(ProcedureSettings settings);

/// Returns the lens as designed for the part of the detector that the testbed's images cover.
[[nodiscard]] LensCalibration lens_as_designed(const twins::camera::CameraSettings& camera,
                                               const twins::camera::Region& region);

/// Returns the lights for images of the board: lamp and the boxes ahead of it, at full power.
[[nodiscard]] LightShares board_lights(const BenchFile& file, double lamp_azimuth_rad);

/// Measures at one posture; no corners where the board is not seen. `exposure_s` is kept for the next measurement.
[[nodiscard]] Measurement measure_board(CalibrationBench& bench, const BoardDesign& board, double& exposure_s);

/// Moves over all postures, then lights and camera. `filter`: postures that may be used.
[[nodiscard]] CalibrationData measure_bench(CalibrationBench& bench, const BenchFile& file, const LensCalibration& lens,
                                            const ProcedureSettings& settings, const PostureFilter& filter,
                                            const Progress& progress);

/// Fits data, and computes the tables of light.
[[nodiscard]] BenchFit calibrate(const CalibrationData& data, const BenchFile& file, const LensCalibration& lens,
                                 const std::string& data_sha256, const Progress& progress);

}  // namespace vbar::tron::calibrate
