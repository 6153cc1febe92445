#include "hil_drivers/optical_stimulator/strip/frame_strip.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;

constexpr int kWhiteReference = 1;

/// The cell of a place in the strip, from the upper left corner of its first pixel; -1: none.
int cell_at(const Vector2& place, int width) {
  const double x = place.x() - cells_left(width), y = place.y() - kCellsTop;
  if (!(x >= 0.0 && x < kCells * kCellSide && y >= 0.0 && y < kCellSide)) return -1;
  return static_cast<int>(x) / kCellSide;
}

/// Camera pixels that a pixel of the display covers.
double area_of(const Vector2& pixel, const CameraPixelOf& camera_pixel_of) {
  const Vector2 right = camera_pixel_of(pixel + Vector2(0.5, 0.0)) - camera_pixel_of(pixel - Vector2(0.5, 0.0));
  const Vector2 down = camera_pixel_of(pixel + Vector2(0.0, 0.5)) - camera_pixel_of(pixel - Vector2(0.0, 0.5));
  return std::abs(right.x() * down.y() - right.y() * down.x());
}

}  // namespace

FrameStrip::FrameStrip(const twins::camera::Region& region, const DisplayLight& light,
                       const CameraPixelOf& camera_pixel_of, const twins::camera::Region& area,
                       double white_electrons) {
  std::array<int, kCells> sizes{};
  double reference = 0.0;
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x) {
      const Vector2 pixel(x, y);
      // From the pixel's corner: an integer is a centre.
      const Vector2 place = camera_pixel_of(pixel) - Vector2(region.x - 0.5, region.y - 0.5);
      const int cell = cell_at(place, region.width);
      if (cell < 0) continue;
      const double covered = area_of(pixel, camera_pixel_of);
      const double full = light.full_electrons(x, y);
      const std::uint8_t white = light.nearest_count(white_electrons * covered / full);
      pixels_.push_back({x, y, cell, white});
      ++sizes[static_cast<std::size_t>(cell)];
      if (cell == kWhiteReference) reference += full * light.fraction(white) / covered;
    }
  for (const int size : sizes)
    if (size < kCellSide * kCellSide / 4)
      throw std::runtime_error("the display does not fill the rows of the frame strip, " + std::to_string(region.y) +
                               " to " + std::to_string(region.y + kStripRows - 1) + " of the camera");
  white_electrons_ = reference / sizes[kWhiteReference];
}

void FrameStrip::draw(std::uint16_t frame, Picture& picture) const {
  const Cells cells = cells_of(frame);
  for (const CellPixel& pixel : pixels_)
    picture.at(pixel.x, pixel.y) = cells[static_cast<std::size_t>(pixel.cell)] ? pixel.white : std::uint8_t{0};
}

}  // namespace vbar::optical_stimulator
