#include "fsw/vision/target_tracking/hot_pixel_map.h"

#include "fsw/math/math.h"

namespace vbar::fsw::target_tracking {

bool HotPixelMap::see(const imaging::DetectedObject& object) {
  if (!is_sharp(object) || !math::is_finite(object.centroid_px.sum())) return false;
  std::size_t k = find(object.centroid_px);
  if (k == kCapacity) {
    k = free_place();
    if (k == kCapacity) return false;
    entries_[k] = {object.centroid_px, image_, 1};
    return false;
  }
  Entry& entry = entries_[k];
  if (entry.last_image != image_ && entry.sightings <= settings_.sightings) ++entry.sightings;
  entry.last_image = image_;
  return entry.sightings > settings_.sightings;
}

int HotPixelMap::sightings_of(const imaging::DetectedObject& object) const {
  if (!is_sharp(object)) return 0;
  const std::size_t k = find(object.centroid_px);
  return k == kCapacity ? 0 : entries_[k].sightings;
}

std::size_t HotPixelMap::known() const {
  std::size_t count = 0;
  for (const Entry& entry : entries_) {
    if (entry.sightings > settings_.sightings) ++count;
  }
  return count;
}

std::size_t HotPixelMap::find(const Vector2& place_px) const {
  for (std::size_t k = 0; k < kCapacity; ++k) {
    const Entry& entry = entries_[k];
    if (entry.sightings == 0 || image_ - entry.last_image > settings_.forget_after) continue;
    const Vector2 offset = place_px - entry.place_px;
    if (math::abs(offset.x()) <= settings_.place_px && math::abs(offset.y()) <= settings_.place_px) return k;
  }
  return kCapacity;
}

std::size_t HotPixelMap::free_place() const {
  std::size_t oldest = kCapacity;
  for (std::size_t k = 0; k < kCapacity; ++k) {
    const Entry& entry = entries_[k];
    if (entry.sightings == 0 || image_ - entry.last_image > settings_.forget_after) return k;
    if (entry.sightings > settings_.sightings || entry.last_image == image_) continue;
    if (oldest == kCapacity || entry.last_image < entries_[oldest].last_image) oldest = k;
  }
  return oldest;
}

}  // namespace vbar::fsw::target_tracking
