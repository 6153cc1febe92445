#pragma once
// The health of cameras, as far as it shows without looking at what an image depicts: images that stop coming, and
// images that are the last one again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/inbox.h"

namespace vbar::fsw::gnc {

class ImageWatch {
 public:
  /// Checks the images of the step. One with the same pixels as the last of its camera is discarded: the noise of no
  /// two images is the same.
  void update(GpsTime now, Inbox& inbox, faults::FaultMonitor& faults);

 private:
  struct Camera {
    std::optional<GpsTime> last;  ///< image
    Duration interval{0};         ///< between the last two
    std::uint64_t sum = 0;        ///< of its pixels
  };

  static constexpr double kMissingIntervals = 3.0;

  [[nodiscard]] static bool is_missing(const Camera& camera, GpsTime now);

  std::array<Camera, packets::kCameras> cameras_{};
};

}  // namespace vbar::fsw::gnc
