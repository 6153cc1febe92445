#pragma once
// Display, camera and rails of a testbed, opened and configured for its calibration.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "hil_drivers/optical_stimulator/display/display.h"
#include "hil_drivers/optical_stimulator/exchange/devices.h"

namespace vbar::optical_stimulator {

struct DevicePlan {
  std::string camera_address;
  std::string rails;  ///< a tty; empty: they are not asked
  DisplaySettings display;
  twins::camera::Region region;  ///< that the camera reads
  double exposure_s = 0.2;
  int packet_size = 1400;
  std::optional<int> packet_delay_us;
  std::chrono::milliseconds timeout{};
  int retries = 3;
};

/// Holds what the camera states of itself.
struct CameraIdentity {
  std::string vendor, model, serial;
  bool is_emulated = false;
};

/// Holds places of the axes, as the rails report them.
struct RailPositions {
  double lens_mm = 0.0, display_mm = 0.0;
};

class BenchDevices {
 public:
  /// Homes the axes if they need it and moves them to the places of the calibration. Throws std::runtime_error, one
  /// sentence, if a device does not answer or is not that of the calibration.
  BenchDevices(const DevicePlan& plan, const BenchCalibration& calibration);
  /// Shows black and releases the camera.
  ~BenchDevices();
  BenchDevices(const BenchDevices&) = delete;
  BenchDevices& operator=(const BenchDevices&) = delete;

  [[nodiscard]] Screen& screen();
  [[nodiscard]] FrameCamera& camera();
  [[nodiscard]] const CameraIdentity& identity() const;
  /// Returns the places of the axes; empty without rails. Throws std::runtime_error if an axis is not held where the
  /// calibration was made.
  [[nodiscard]] std::optional<RailPositions> check_rails();
  /// Stops from another thread: the camera does not wait for an image any longer.
  void stop() noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vbar::optical_stimulator
