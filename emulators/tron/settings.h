#pragma once
// File of an emulator (data/benches/tron_emulated.toml): the laboratory, hidden errors, clock, camera.
// Neither driver nor calibration reads it.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "emulators/tron/controller/cycle_clock.h"
#include "emulators/tron/faults.h"
#include "emulators/tron/lights.h"
#include "emulators/tron/scene/lab_view.h"
#include "emulators/tron/world/motion_capture.h"
#include "emulators/tron/world/world.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

struct CameraIdentity {
  std::string vendor = "Point Grey Research";
  std::string model = "Grasshopper3 GS3-PGE-23S6M";
  std::string serial;  ///< empty: drawn from the seed
};

/// Describes the sensor of the emulated camera.
struct SensorSettings {
  double gain_dn_per_electron = 0.125;
  double read_noise_electrons = 7.0;
  double photo_response_nonuniformity = 0.01;
  int hot_pixels = 20;
};

struct BenchSettings {
  TestbedDesign laboratory;
  std::uint64_t seed = 1;
  ClockSettings clock;
  ErrorSizes errors;
  CameraIdentity identity;
  SensorSettings sensor;
  CaptureErrorSizes capture;
  std::size_t vicon_block_bytes = 1024;  ///< size of a datagram; 0: as long as its objects
  LightErrorSizes lights;
  GapSettings gap;
  std::vector<Fault> faults;
};

/// Reads the file with `assignments` (key=value) in place of its values; "laboratory.<key>=value" is one of the
/// laboratory. Throws mission::MissionError.
[[nodiscard]] BenchSettings read_bench(const std::filesystem::path& file, const std::vector<std::string>& assignments);

/// Returns lens and detector as they really are: those of the camera's file with the errors of the emulator. The region
/// is the whole detector.
[[nodiscard]] twins::camera::CameraSettings true_camera(const BenchSettings& settings,
                                                        const std::filesystem::path& data_directory);

}  // namespace vbar::tron::bench
