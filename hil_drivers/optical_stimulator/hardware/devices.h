#pragma once
// Display, camera and rails of a testbed, opened and configured for its calibration.

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "hil_drivers/optical_stimulator/hardware/display.h"
#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"

namespace vbar::optical_stimulator {

// Addresses of a testbed's devices: addresses.json of an emulator.

struct TestbedAddresses {
  std::string display;  ///< name of its X server
  std::string camera;   ///< IP address
  std::string rails;    ///< a tty
};

/// Throws std::runtime_error that names the file.
[[nodiscard]] TestbedAddresses read_addresses(const std::filesystem::path& file);

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

class StimulatorDevices {
 public:
  /// Homes the axes if they need it and moves them to the places of the calibration. Throws std::runtime_error, one
  /// sentence, if a device does not answer or is not that of the calibration.
  StimulatorDevices(const DevicePlan& plan, const StimulatorCalibration& calibration);
  /// Shows black and releases the camera.
  ~StimulatorDevices();
  StimulatorDevices(const StimulatorDevices&) = delete;
  StimulatorDevices& operator=(const StimulatorDevices&) = delete;

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
