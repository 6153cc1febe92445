#pragma once
// Interfaces of display and camera to the exchange of a picture for an image.

#include <cstdint>
#include <vector>

#include "hil_drivers/optical_stimulator/counts/picture.h"

namespace vbar::optical_stimulator {

class Screen {
 public:
  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  virtual ~Screen() = default;

  /// Returns when the picture is on the screen. Throws std::runtime_error, one sentence.
  virtual void show(const Picture& picture) = 0;
};

struct CameraFrame {
  std::vector<std::uint16_t> dn;  ///< pixels of the region, rows from the top
  int packets_resent = 0;
  int tries = 1;           ///< triggers until it was whole
  double receive_s = 0.0;  ///< wall clock, from the trigger
};

class FrameCamera {
 public:
  FrameCamera() = default;
  FrameCamera(const FrameCamera&) = delete;
  FrameCamera& operator=(const FrameCamera&) = delete;
  virtual ~FrameCamera() = default;

  /// Takes a new exposure, whole. Throws std::runtime_error, one sentence that names the camera, if it does not
  /// deliver.
  virtual CameraFrame take() = 0;
  /// Opens the camera again with all its settings. Throws as take().
  virtual void reopen() = 0;
};

}  // namespace vbar::optical_stimulator
