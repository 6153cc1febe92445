#pragma once
// Draws the frame strip on the display.

#include <functional>
#include <vector>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/counts/display_light.h"
#include "hil_drivers/optical_stimulator/strip/strip_layout.h"

namespace vbar::optical_stimulator {

/// Returns the camera pixel (of the detector) that a pixel of the display illuminates.
using CameraPixelOf = std::function<fsw::Vector2(const fsw::Vector2& display_pixel)>;

class FrameStrip {
 public:
  /// `region`: that is read, the strip's rows first; `white_electrons`: a camera pixel and exposure in a white cell.
  /// `area`: of the display, in which all pixels of the strip lie. Throws std::runtime_error if the display does not
  /// reach all cells.
  FrameStrip(const twins::camera::Region& region, const DisplayLight& light, const CameraPixelOf& camera_pixel_of,
             const twins::camera::Region& area, double white_electrons);

  /// Replaces the pixels of all cells.
  void draw(std::uint16_t frame, Picture& picture) const;

  /// Returns the light of a camera pixel in the white reference cell, as its counts give: near the electrons asked for.
  [[nodiscard]] double white_electrons() const { return white_electrons_; }

 private:
  struct CellPixel {
    int x = 0, y = 0, cell = 0;
    std::uint8_t white = 0;
  };

  std::vector<CellPixel> pixels_;
  double white_electrons_ = 0.0;
};

}  // namespace vbar::optical_stimulator
