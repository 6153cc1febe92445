#pragma once
// Source of poses of motion capture. The driver runs robot cycles and then drains what has arrived, so that bench
// time decides how much that is; it waits in wall clock for frames that do not depend on its cycles.

#include <chrono>
#include <cstdint>
#include <string>

#include "hil_drivers/tron/vicon/object_average.h"

namespace vbar::tron::vicon {

/// States which objects have moved since the average before.
struct Moved {
  bool camera = true, target = true;
};

struct CaptureAverage {
  ObjectAverage camera, target;
  [[nodiscard]] bool is_tracked() const {
    return camera.state == ObjectState::kTracked && target.state == ObjectState::kTracked;
  }
};

struct CaptureCounts {
  std::uint64_t frames = 0;
  std::uint64_t frames_lost = 0;                                    ///< gaps of the frame numbers
  std::uint64_t late_blocks = 0;                                    ///< blocks of a frame before the last one; ignored
  std::uint64_t restarts = 0;                                       ///< restarts of the frame numbers
  std::uint64_t unreadable = 0;                                     ///< datagrams
  std::uint64_t silent = 0, missing = 0, occluded = 0, frozen = 0;  ///< averages of an object
  std::string last_unreadable;                                      ///< why
};

class CaptureSource {
 public:
  CaptureSource() = default;
  CaptureSource(const CaptureSource&) = delete;
  CaptureSource& operator=(const CaptureSource&) = delete;
  virtual ~CaptureSource() = default;

  /// Takes and discards what has arrived: frames after this call belong to the objects at rest.
  virtual void clear() = 0;
  /// Takes what has arrived, without waiting; returns the frames since clear(). Throws std::runtime_error.
  virtual int drain() = 0;
  /// Calls drain() until there are `frames` since clear(), at most for `timeout` of wall clock.
  virtual int wait_for(int frames, std::chrono::milliseconds timeout) = 0;

  /// Returns the average of the last `frames` since clear(). An object is tracked if it was in at least half of that
  /// number.
  [[nodiscard]] virtual CaptureAverage average(int frames, const Moved& moved) = 0;

  [[nodiscard]] virtual CaptureCounts counts() const = 0;
  /// Returns the name for messages: "Vicon at UDP port 51001".
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace vbar::tron::vicon
