#pragma once
// Radiance of the laboratory on the raster of the detector, by OpenGL.
//
// Distortion is applied to corners of triangles, which are subdivided so far that a straight edge between them deviates
// from the true curve by about a hundredth of a pixel. An undistorted picture that is resampled would cost a second
// interpolation, and its blur.

#include <cstdint>
#include <filesystem>
#include <memory>

#include "emulators/tron/scene/lab_renderer.h"
#include "emulators/tron/scene/lab_view.h"

namespace vbar::tron::bench {

class LabDrawing {
 public:
  /// Throws as LabRenderer.
  LabDrawing(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed,
             const std::filesystem::path& data_directory);
  ~LabDrawing();
  LabDrawing(const LabDrawing&) = delete;
  LabDrawing& operator=(const LabDrawing&) = delete;

  /// Computes means over the pixels of `area`, which need not be on the detector, in units of unit(). Returns the
  /// distance of the target's or board's middle. Throws std::invalid_argument if the camera is inside the sphere around
  /// it.
  double draw(const LabView& view, const twins::camera::Region& area, Plane& plane);

  /// Returns the unit, photons/(m^2 s sr), of the last drawing.
  [[nodiscard]] double unit() const;

 private:
  struct Gl;
  std::unique_ptr<Gl> gl_;
};

}  // namespace vbar::tron::bench
