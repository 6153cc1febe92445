#pragma once
// A scene, its exposure and what the detector finds in it.

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "fsw/imaging/object_detector.h"
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

}  // namespace vbar::fsw::imaging
