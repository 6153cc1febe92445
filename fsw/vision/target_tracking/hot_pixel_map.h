#pragma once
// Hot pixels learned on board. A hot pixel is a single pixel of the detector that is bright in successive images, while
// the stars move through the field. The target, too, stays near one position, as the camera follows it; but its light
// is spread over several pixels and pointing jitter moves it. Therefore only objects sharper than the camera's
// point-spread function are learned, and only such objects are matched with known hot pixels.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/vision/imaging/components.h"

namespace vbar::fsw::target_tracking {

struct HotPixelSettings {
  double min_sharpness = 0.5;  ///< smallest share of its light in one pixel
  double place_px = 0.6;       ///< largest distance of its centroid from the first one, each axis
  int sightings = 4;           ///< number of sightings that makes it a known hot pixel
  int forget_after = 60;       ///< number of images without a sighting until it is discarded
};

class HotPixelMap {
 public:
  static constexpr std::size_t kCapacity = 96;

  explicit HotPixelMap(const HotPixelSettings& settings = {}) : settings_(settings) {}

  /// Starts an image: all its objects that are not stars are then passed to see().
  void begin_image() { ++image_; }

  /// Returns true if the object is a known hot pixel, seen often enough before and sharp. Otherwise learns it if it is
  /// sharp. An entry is free if its pixel was not seen for `forget_after` images; without a free entry, the one that is
  /// unseen for longest among those not yet known is replaced.
  bool see(const imaging::DetectedObject& object);

  /// Returns how often a sharp object was seen at this position, this image included; 0 if the object is not sharp.
  [[nodiscard]] int sightings_of(const imaging::DetectedObject& object) const;

  [[nodiscard]] std::size_t known() const;

 private:
  struct Entry {
    Vector2 place_px = Vector2::Zero();
    std::int32_t last_image = 0;
    std::int32_t sightings = 0;  ///< 0: free
  };

  [[nodiscard]] bool is_sharp(const imaging::DetectedObject& object) const {
    return object.sharpness >= settings_.min_sharpness;
  }
  [[nodiscard]] std::size_t find(const Vector2& place_px) const;
  [[nodiscard]] std::size_t free_place() const;

  HotPixelSettings settings_;
  std::array<Entry, kCapacity> entries_{};
  std::int32_t image_ = 0;
};

}  // namespace vbar::fsw::target_tracking
