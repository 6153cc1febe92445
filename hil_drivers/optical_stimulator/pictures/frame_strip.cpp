#include "hil_drivers/optical_stimulator/pictures/frame_strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace vbar::optical_stimulator {

namespace {

using fsw::Vector2;

// Cells of the strip.
constexpr int kBlackReference = 0, kWhiteReference = 1, kNumberFirst = 2, kCheckFirst = kNumberFirst + kNumberBits;
constexpr int kMarkFirst = kCheckFirst + kCheckBits;

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

namespace {

constexpr int kCellMargin = 5;  // px of a cell left out: neighbours and the halo

/// CRC-4 of ITU-T G.704, x^4 + x + 1, initialised with ones so that a strip of zeros is not valid.
unsigned check_of(std::uint16_t frame) {
  unsigned crc = 0xF;
  for (int bit = kNumberBits - 1; bit >= 0; --bit) {
    const unsigned feedback = ((crc >> 3) ^ (static_cast<unsigned>(frame) >> bit)) & 1U;
    crc = (crc << 1) & 0xFU;
    if (feedback != 0) crc ^= 0x3U;
  }
  return crc;
}

double mean_of_cell(std::span<const std::uint16_t> dn, int width, int cell) {
  double sum = 0.0;
  const int left = cells_left(width) + cell * kCellSide;
  for (int y = kCellsTop + kCellMargin; y < kCellsTop + kCellSide - kCellMargin; ++y)
    for (int x = left + kCellMargin; x < left + kCellSide - kCellMargin; ++x)
      sum += dn[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  constexpr int kSide = kCellSide - 2 * kCellMargin;
  return sum / (kSide * kSide);
}

bool has_mark(const Cells& cells) {
  return !cells[kBlackReference] && cells[kWhiteReference] && cells[kMarkFirst] && cells[kMarkFirst + 1];
}

}  // namespace

Cells cells_of(std::uint16_t frame) {
  Cells cells{};
  cells[kWhiteReference] = cells[kMarkFirst] = cells[kMarkFirst + 1] = true;
  for (int bit = 0; bit < kNumberBits; ++bit)
    cells[static_cast<std::size_t>(kNumberFirst + bit)] = ((frame >> (kNumberBits - 1 - bit)) & 1) != 0;
  for (int bit = 0; bit < kCheckBits; ++bit)
    cells[static_cast<std::size_t>(kCheckFirst + bit)] = ((check_of(frame) >> (kCheckBits - 1 - bit)) & 1U) != 0;
  return cells;
}

twins::camera::Region region_with_strip(const twins::camera::Region& image) {
  if (image.y < kStripRows)
    throw std::invalid_argument("the image begins in row " + std::to_string(image.y) + ": the frame strip needs " +
                                std::to_string(kStripRows) + " rows of the detector above it");
  if (image.width < kCells * kCellSide)
    throw std::invalid_argument("the image is " + std::to_string(image.width) + " pixels wide: the frame strip needs " +
                                std::to_string(kCells * kCellSide));
  return {image.x, image.y - kStripRows, image.width, image.height + kStripRows};
}

StripReading read_strip(std::span<const std::uint16_t> dn, int width, double contrast_dn) {
  if (width < kCells * kCellSide || dn.size() < static_cast<std::size_t>(width) * kStripRows)
    throw std::invalid_argument("the image does not hold a frame strip");
  std::array<double, kCells> means;
  for (int cell = 0; cell < kCells; ++cell) means[static_cast<std::size_t>(cell)] = mean_of_cell(dn, width, cell);
  const auto [darkest, brightest] = std::ranges::minmax(means);
  StripReading reading;
  reading.black_dn = darkest;
  reading.white_dn = brightest;
  if (!(brightest - darkest >= contrast_dn)) return reading;

  const double middle = 0.5 * (darkest + brightest);
  Cells cells;
  std::ranges::transform(means, cells.begin(), [middle](double mean) { return mean > middle; });
  if (!has_mark(cells)) {
    std::ranges::reverse(cells);
    reading.status = has_mark(cells) ? StripStatus::kMirrored : StripStatus::kDamaged;
    return reading;
  }
  unsigned frame = 0;
  for (int bit = 0; bit < kNumberBits; ++bit)
    frame = 2U * frame + (cells[static_cast<std::size_t>(kNumberFirst + bit)] ? 1U : 0U);
  reading.frame = static_cast<std::uint16_t>(frame);
  reading.status = cells == cells_of(reading.frame) ? StripStatus::kRead : StripStatus::kDamaged;
  reading.black_dn = means[kBlackReference];
  reading.white_dn = means[kWhiteReference];
  return reading;
}

}  // namespace vbar::optical_stimulator
