#pragma once
// Hot pixels learned on board. A hot pixel is a single pixel of the detector that shows in image after image, while
// the stars run through the field. The target, too, stays near one place, since the camera follows it; but its light
// spreads over several pixels and pointing jitter moves it. So only objects too sharp for the camera's point-spread
// function are learned, and only such are taken for a known hot pixel.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/imaging/detected_object.h"

namespace vbar::fsw::tracking {

struct HotPixelSettings {
  double least_sharpness = 0.5;  ///< share of its light in one pixel
  double place_px = 0.6;         ///< its centroid stays within this of the first, each axis
  int sightings = 4;             ///< so many make it known
  int forget_after = 60;         ///< images without it
};

class HotPixelMap {
 public:
  static constexpr std::size_t kCapacity = 96;

  explicit HotPixelMap(const HotPixelSettings& settings = {}) : settings_(settings) {}

  /// Opens an image: all its objects that are no stars are then given to see().
  void begin_image() { ++image_; }

  /// True if the object is a known hot pixel, seen often enough before and sharp. Learns it otherwise, if it is sharp;
  /// a place is free if its pixel was not seen for `forget_after` images, or else for the longest time of those not
  /// yet known.
  bool see(const imaging::DetectedObject& object);

  /// How often the object's place has shown something sharp, this image included; 0 if the object is not sharp.
  [[nodiscard]] int sightings_of(const imaging::DetectedObject& object) const;

  [[nodiscard]] std::size_t known() const;

 private:
  struct Entry {
    Vector2 place_px = Vector2::Zero();
    std::int32_t last_image = 0;
    std::int32_t sightings = 0;  ///< 0: free
  };

  [[nodiscard]] bool is_sharp(const imaging::DetectedObject& object) const {
    return object.sharpness >= settings_.least_sharpness;
  }
  [[nodiscard]] std::size_t find(const Vector2& place_px) const;
  [[nodiscard]] std::size_t free_place() const;

  HotPixelSettings settings_;
  std::array<Entry, kCapacity> entries_{};
  std::int32_t image_ = 0;
};

}  // namespace vbar::fsw::tracking
