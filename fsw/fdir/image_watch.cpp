#include "fsw/fdir/image_watch.h"

namespace vbar::fsw::fdir {
namespace {

/// Returns a checksum of every pixel and its place (Fowler, Noll, Vo 1991). It is 0 only for an image without
/// variation, as of a camera whose noise is not modelled.
std::uint64_t sum_of(const imaging::ImageView& image) {
  constexpr std::uint64_t kOffset = 0xCBF29CE484222325U;
  constexpr std::uint64_t kPrime = 0x100000001B3U;
  std::uint64_t sum = kOffset;
  bool has_variation = false;
  for (const std::uint16_t pixel : image.pixels) {
    sum = (sum ^ pixel) * kPrime;
    has_variation = has_variation || pixel != image.pixels.front();
  }
  return has_variation ? sum : 0;
}

}  // namespace

bool ImageWatch::is_missing(const Camera& camera, GpsTime now) {
  if (!camera.last || camera.interval.ns <= 0) return false;
  return seconds(now - *camera.last) > kMissingIntervals * seconds(camera.interval);
}

void ImageWatch::update(GpsTime now, messaging::Inbox& inbox, faults::FaultMonitor& faults) {
  bool is_any_missing = false;
  bool is_any_frozen = false;
  double concerned = 0.0;
  for (std::size_t unit = 0; unit < cameras_.size(); ++unit) {
    Camera& camera = cameras_[unit];
    const imaging::ImageAssembly& image = inbox.image(unit);
    if (image.has_image()) {
      const std::uint64_t sum = sum_of(image.view());
      const bool is_frozen = sum != 0 && sum == camera.sum;
      camera.sum = sum;
      if (camera.last && image.image_time() > *camera.last) camera.interval = image.image_time() - *camera.last;
      camera.last = image.image_time();
      if (is_frozen) {
        inbox.discard_image(unit);
        is_any_frozen = true;
        concerned = static_cast<double>(unit);
      }
    } else if (is_missing(camera, now)) {
      is_any_missing = true;
      concerned = static_cast<double>(unit);
    }
  }
  faults.check(now,
               {.fault = telemetry_health::kFaultImagesMissing, .is_detected = is_any_missing, .argument = concerned});
  faults.check(now,
               {.fault = telemetry_health::kFaultImageFrozen, .is_detected = is_any_frozen, .argument = concerned});
}

}  // namespace vbar::fsw::fdir
