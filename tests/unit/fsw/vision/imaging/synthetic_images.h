#pragma once
// A scene, its exposure and what the detector finds in it.

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/image.h"
#include "fsw/vision/imaging/object_detector.h"
#include "tests/support/synthetic_image.h"

namespace vbar::fsw::imaging {

class Detection {
 public:
  DetectionReport expose(const test::SyntheticImage& scene) {
    width = scene.width();
    height = scene.height();
    pixels = scene.expose(detector, random);
    return detect();
  }
  DetectionReport detect() { return objects->detect(test::view_of(pixels, width, height), settings); }

  /// Nearest object within so many pixels; null if there is none.
  [[nodiscard]] const DetectedObject* near(double x, double y, double within = 2.0) const {
    const DetectedObject* nearest = nullptr;
    for (const DetectedObject& object : objects->objects()) {
      const double distance = std::hypot(object.centroid_px.x() - x, object.centroid_px.y() - y);
      if (distance > within) continue;
      within = distance;
      nearest = &object;
    }
    return nearest;
  }

  test::SyntheticDetector detector;
  DetectorSettings settings;
  std::mt19937_64 random{1};
  std::unique_ptr<ObjectDetector> objects = std::make_unique<ObjectDetector>();
  std::vector<std::uint16_t> pixels;
  int width = 0;
  int height = 0;
};

/// Electrons that the reference camera gets of a star of this magnitude.
inline double electrons_of(double magnitude) {
  return 900.0 * std::pow(10.0, 0.4 * (7.5 - magnitude));
}

/// A point as the reference camera's lens makes it: a core and a hundredth of the light scattered about.
inline void add_lens_point(test::SyntheticImage& scene, double x, double y, double electrons) {
  scene.add({x, y, 0.99 * electrons, 0.8});
  scene.add({x, y, 0.01 * electrons, 4.0});
}

// An image cut into tiles, byte by byte from the text of vbar.lcm and not by the code under test.

inline std::vector<image_tile> tiles_of(const std::vector<std::uint16_t>& pixels, const ImageFrame& frame,
                                        int image_number) {
  const std::size_t of_tile = frame.bits == 12 ? 868 : 1302;
  const std::size_t count = (pixels.size() + of_tile - 1) / of_tile;
  std::vector<image_tile> tiles;
  for (std::size_t k = 0; k < count; ++k) {
    image_tile tile{};
    tile.image = image_number;
    tile.tile = static_cast<std::int16_t>(k);
    tile.tiles = static_cast<std::int16_t>(count);
    tile.width = static_cast<std::int16_t>(frame.width);
    tile.height = static_cast<std::int16_t>(frame.height);
    tile.origin_x = static_cast<std::int16_t>(frame.origin_x);
    tile.origin_y = static_cast<std::int16_t>(frame.origin_y);
    tile.bits = static_cast<std::int8_t>(frame.bits);
    const std::size_t first = k * of_tile;
    const std::size_t number = std::min(of_tile, pixels.size() - first);
    tile.pixels = static_cast<std::int16_t>(number);
    // A string of digits of four bits each: three a pixel, or two
    std::vector<unsigned> digits;
    for (std::size_t i = first; i < first + number; ++i) {
      const unsigned p = pixels[i];
      if (frame.bits == 12) digits.push_back(p / 256);
      digits.push_back(p / 16 % 16);
      digits.push_back(p % 16);
    }
    if (digits.size() % 2 != 0) digits.push_back(0);
    for (std::size_t i = 0; i < digits.size() / 2; ++i) {
      tile.data[i] = static_cast<std::uint8_t>(digits[2 * i] * 16 + digits[2 * i + 1]);
    }
    tiles.push_back(tile);
  }
  return tiles;
}

}  // namespace vbar::fsw::imaging
