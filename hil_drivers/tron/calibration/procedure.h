#pragma once
// A calibration from the first posture to the file.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/tron/calibration/calibration_data.h"
#include "hil_drivers/tron/calibration/pose_choice.h"
#include "hil_drivers/tron/calibration/testbed_fit.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::calibrate {

// Interface of a testbed to its calibration, over its wires or simulated.

/// Names what the plate of the target's arm carries.
enum class Mounted { kTarget, kBoard };

/// Holds values of the lights, shares of the largest, not of light.
struct LightShares {
  double lamp = 0.0;
  double lamp_azimuth_rad = 0.0;
  std::array<double, kBoxes> boxes{};
};

struct CalibrationImage {
  int width = 0, height = 0, bits = 12;
  std::vector<std::uint16_t> dn;  ///< rows from the top
};

struct MeasuredPosture {
  Posture posture;  ///< as the controllers state it, at rest
  std::optional<ViconObjects> vicon;
};

struct TestbedIdentity {
  std::string camera_model, camera_serial;
  bool is_emulated = false;
};

/// Gives a calibration access to a testbed. All functions throw std::runtime_error, one sentence that names the device,
/// if the testbed cannot go on.
class CalibrationTestbed {
 public:
  CalibrationTestbed() = default;
  CalibrationTestbed(const CalibrationTestbed&) = delete;
  CalibrationTestbed& operator=(const CalibrationTestbed&) = delete;
  virtual ~CalibrationTestbed() = default;

  [[nodiscard]] virtual TestbedIdentity identity() = 0;
  /// Mounts mock-up or board: an emulator does it by itself; at a real testbed the operator is asked to.
  virtual void mount(Mounted what) = 0;
  /// Moves and waits until the arms have settled; false: there is no way without a collision.
  [[nodiscard]] virtual bool move(const Posture& posture) = 0;
  [[nodiscard]] virtual MeasuredPosture measure() = 0;
  /// Waits until the lights act.
  virtual void light(const LightShares& shares) = 0;
  [[nodiscard]] virtual CalibrationImage take(double exposure_s) = 0;
};

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
[[nodiscard]] LightShares board_lights(const TestbedDesign& file, double lamp_azimuth_rad);

/// Measures at one posture; no corners where the board is not seen. `exposure_s` is kept for the next measurement.
[[nodiscard]] Measurement measure_board(CalibrationTestbed& bench, const BoardDesign& board, double& exposure_s);

/// Moves over all postures, then lights and camera. `filter`: postures that may be used.
[[nodiscard]] CalibrationData measure_testbed(CalibrationTestbed& bench, const TestbedDesign& file,
                                              const LensCalibration& lens, const ProcedureSettings& settings,
                                              const PostureFilter& filter, const Progress& progress);

/// Fits data, and computes the tables of light.
[[nodiscard]] TestbedFit calibrate(const CalibrationData& data, const TestbedDesign& file, const LensCalibration& lens,
                                   const std::string& data_sha256, const Progress& progress);

// Check of a calibration: a few postures measured once more.

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
[[nodiscard]] CheckResult judge(const Calibration& calibration, const TestbedDesign& file,
                                const std::vector<Measurement>& measurements);

/// Measures at `poses` postures and judges.
[[nodiscard]] CheckResult check(CalibrationTestbed& bench, const TestbedDesign& file, const Calibration& calibration,
                                int poses, std::uint64_t seed, const PostureFilter& filter, const Progress& progress);

// Light of the sources at levels of their values, and the camera without light.

/// Returns the mean and, from differences of successive images, the noise of a pixel in images with all lights off.
[[nodiscard]] DarkFigures measure_dark(CalibrationTestbed& bench, double exposure_s, int images = 4);

/// Measures each source alone at `levels` levels up to the full one. A posture to which there is no way is left out.
[[nodiscard]] std::vector<LightSample> measure_lights(CalibrationTestbed& bench, const LensCalibration& lens,
                                                      const TestbedDesign& file, const BoardDesign& board,
                                                      const std::vector<PatchPosture>& postures,
                                                      double lamp_azimuth_rad, int levels);

/// Returns the sources that have samples.
[[nodiscard]] SourceFlags measured_sources(const std::vector<LightSample>& samples);

/// Returns the light relative to full power as designed, for the lamp relative to its own full power. A level at which
/// the light does not rise above that of the level before is left out.
[[nodiscard]] std::vector<LightTable> light_tables(const std::vector<LightSample>& samples);

/// Returns the level of the lamp at full power on the white patch facing it, DN per second; 0 if it was not measured.
[[nodiscard]] double lamp_dn_per_s(const std::vector<LightSample>& samples);

// A calibration as one HTML page.

[[nodiscard]] std::string calibration_page(const TestbedFit& fit, const CalibrationData& data);

}  // namespace vbar::tron::calibrate
