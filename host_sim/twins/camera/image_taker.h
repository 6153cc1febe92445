#pragma once
// Converts an exposure into pixels: the renderer and the detector of the digital twin, or the driver of an optical
// testbed. Timing, numbering and packets are the sensor's (camera_sensor.h).

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

struct TakenImage {
  std::vector<std::uint16_t> dn;  ///< the pixels of the camera's region, rows from the top
  std::vector<Note> notes = {};   ///< on this image: achieved pose, retries
  std::string failure = {};       ///< if there is no image: why, one sentence
};

class ImageTaker {
 public:
  ImageTaker() = default;
  ImageTaker(const ImageTaker&) = delete;
  ImageTaker& operator=(const ImageTaker&) = delete;
  virtual ~ImageTaker() = default;

  // As those of PacketSource.
  virtual void start(fsw::GpsTime first_epoch) { static_cast<void>(first_epoch); }
  /// Stops the taker, from another thread than take(), which then returns without delay.
  virtual void stop(StopReason reason) { static_cast<void>(reason); }

  /// Takes an image, on the sensor's own thread, always the same one. An exception ends the run.
  virtual TakenImage take(const Exposure& exposure) = 0;

  /// Returns whether take() is a pure function of the exposure, so that a log may keep the exposure in place of the
  /// pixels.
  [[nodiscard]] virtual bool is_reproducible() const { return false; }

  /// Returns the figures so far; also called while take() runs.
  [[nodiscard]] virtual std::vector<Note> statistics() const { return {}; }
};

}  // namespace vbar::twins::camera
