#pragma once
// Testbed under calibration over its wires: X display, GigE Vision camera, Zaber rails.

#include <chrono>
#include <memory>
#include <string>

#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "hil_drivers/optical_stimulator/hardware/display.h"

namespace vbar::optical_stimulator::calibrate {

struct WiredBenchSettings {
  DisplaySettings display;
  std::string camera_address;
  std::string rails;  ///< a tty, or host:port
  int packet_size = 1400;
  std::chrono::milliseconds settle{50};  ///< from a picture on the screen to its light
  std::chrono::milliseconds timeout{10000};
  int retries = 5;                             ///< tries for an image
  int width = 1920, height = 1200, bits = 12;  ///< size and resolution of the camera
};

class WiredTestbed {
 public:
  /// Throws std::runtime_error, one sentence, if a device does not answer.
  explicit WiredTestbed(const WiredBenchSettings& settings);
  ~WiredTestbed();
  WiredTestbed(const WiredTestbed&) = delete;
  WiredTestbed& operator=(const WiredTestbed&) = delete;

  [[nodiscard]] Bench bench();
  /// Fills in the camera and whether the testbed is emulated.
  void identify(Validity& validity) const;
  [[nodiscard]] std::string transport() const;
  [[nodiscard]] int frames() const;
  [[nodiscard]] int repeated_frames() const;  ///< that did not arrive whole

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vbar::optical_stimulator::calibrate
