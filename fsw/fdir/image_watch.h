#pragma once
// The health of cameras, independent of what their images depict: missing images, and repetitions of the last image.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/messaging/inbox.h"

namespace vbar::fsw::fdir {

class ImageWatch {
 public:
  /// Checks the images of the step. An image with the same pixels as the last one of its camera is discarded: the noise
  /// of two images differs.
  void update(GpsTime now, messaging::Inbox& inbox, faults::FaultMonitor& faults);

 private:
  struct Camera {
    std::optional<GpsTime> last;  ///< time of the last image
    Duration interval{0};         ///< interval between the last two
    std::uint64_t sum = 0;        ///< checksum of its pixels
  };

  static constexpr double kMissingIntervals = 3.0;

  [[nodiscard]] static bool is_missing(const Camera& camera, GpsTime now);

  std::array<Camera, packets::kCameras> cameras_{};
};

}  // namespace vbar::fsw::fdir
