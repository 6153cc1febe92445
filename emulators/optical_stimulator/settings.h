#pragma once
// File of an emulator: its true optics, display, camera, rails and drift. Neither driver nor calibration
// reads it.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "emulators/optical_stimulator/faults.h"
#include "emulators/optical_stimulator/optics.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::optical_stimulator::bench {

enum class Pace { kReal, kFast };

struct DisplaySettings {
  int width = 1920, height = 1200;
  double refresh_hz = 60.0;
  int latency_frames = 1;    ///< from the X server's screen to the light; pace "real"
  double response_ms = 1.0;  ///< time constant of a pixel; pace "real"
};

/// Differences between the camera in front of the display and its file.
struct CameraErrors {
  std::string file = "optical_stimulator";
  double gain_factor = 1.03;
  double read_noise_factor = 1.10;
  double offset_dn = 2.0;
  int hot_pixels = 20;
};

struct CameraIdentity {
  std::string vendor = "Point Grey Research";
  std::string model = "Grasshopper3 GS3-PGE-23S6M";
  std::string serial;  ///< empty: drawn from the seed
};

struct RailSettings {
  double microstep_um = 0.047625;
  double backlash_um = 3.0;
  double repeatability_um = 0.5;  ///< one sigma of a place that is approached
  double travel_mm = 101.6;       ///< length of each axis
  double lens_zero_mm = 15.0;     ///< distance of the lenses with axis 1 at home
  double display_zero_mm = 20.0;  ///< display behind lens 2 with axis 2 at home
  double zero_error_mm = 0.1;     ///< one sigma of both, from the seed
  double speed_mm_s = 20.0;       ///< at the start
};

struct DriftSettings {
  int day = 0;                ///< 0: that of the calibration
  double day_shift_um = 1.0;  ///< between two days
  double day_scale_ppm = 20.0;
  double run_shift_um = 0.5;  ///< from the first frame of a session to frame run_frames
  double run_scale_ppm = 5.0;
  int run_frames = 2159;
};

struct BenchSettings {
  std::uint64_t seed = 1;
  Pace pace = Pace::kFast;
  bool noise = true;  ///< noise of the detector; false: expected electrons, rounded
  LensPair lenses;
  DisplayPose pose;
  OpticsErrors optics;
  FieldSettings field;
  DisplayLight light;
  DisplaySettings display;
  CameraErrors camera;
  CameraIdentity identity;
  RailSettings rails;
  DriftSettings drift;
  std::vector<Fault> faults;
};

/// Reads the emulator's file with `assignments` (key=value) in place of its values. Throws mission::MissionError.
[[nodiscard]] BenchSettings read_bench(const std::filesystem::path& file, const std::vector<std::string>& assignments);

/// Returns the camera's own figures: those of its file with the errors of the emulator. The region is the whole
/// detector.
[[nodiscard]] twins::camera::CameraSettings camera_of(const BenchSettings& settings,
                                                      const std::filesystem::path& data_directory);

}  // namespace vbar::optical_stimulator::bench
