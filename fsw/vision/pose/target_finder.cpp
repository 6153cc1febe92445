#include "fsw/vision/pose/target_finder.h"

#include "fsw/math/math.h"

namespace vbar::fsw::pose {
namespace {

constexpr double kMaxSaturated = 0.4;  ///< largest part of saturated pixels
constexpr int kReach = 2;              ///< blocks: a single dark block is not a gap
constexpr int kMinLit = 5;             ///< blocks: larger than any speck
constexpr int kMinBlocks = 12;
constexpr int kMinSide = 6;          ///< blocks: 48 px
constexpr int kMaxSide = 80;         ///< blocks: 640 px
constexpr double kMaxAtEdge = 0.5;   ///< blocks at the image's edge, of the structure's longer side
constexpr double kMinFilled = 0.12;  ///< smallest part of its rectangle that a structure fills
constexpr double kNoises = 6.0;
constexpr int kMaxLevels = 8;
constexpr double kLevelFactor = 2.5;
constexpr double kMargin = 1.3;

int smaller(int a, int b) {
  return a < b ? a : b;
}

int larger(int a, int b) {
  return a > b ? a : b;
}

/// Mean of the middle two of four values, minimum of fewer: a speck lies in one quarter of a block.
double without_speck(const std::array<double, 4>& values, int count) {
  double minimum = values[0];
  double maximum = values[0];
  double sum = 0.0;
  for (int k = 0; k < count; ++k) {
    const double value = values[static_cast<std::size_t>(k)];
    if (value < minimum) minimum = value;
    if (value > maximum) maximum = value;
    sum += value;
  }
  return count == 4 ? 0.5 * (sum - minimum - maximum) : minimum;
}

}  // namespace

void TargetFinder::average_block(const imaging::ImageView& image, const DetectorLevels& levels, int column, int row) {
  constexpr int kHalf = kBlock / 2;
  std::array<double, 4> quarters{};
  int quarters_there = 0;
  for (int q = 0; q < 4; ++q) {
    const int left = column * kBlock + (q % 2) * kHalf;
    const int top = row * kBlock + (q / 2) * kHalf;
    std::int32_t sum = 0;
    int count = 0;
    for (int y = top; y < smaller(top + kHalf, image.frame.height); ++y) {
      const std::uint16_t* pixels = image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.frame.width;
      for (int x = left; x < smaller(left + kHalf, image.frame.width); ++x) {
        if (pixels[x] == imaging::kMissingPixel) continue;
        sum += pixels[x];
        ++count;
        if (pixels[x] >= levels.saturation_dn) ++saturated_;
      }
    }
    pixels_there_ += count;
    if (count == 0) continue;
    quarters[static_cast<std::size_t>(quarters_there++)] = static_cast<double>(sum) / count - levels.dark_level_dn;
  }
  double& light = light_[place(column, row)];
  if (quarters_there > 0) {
    light = without_speck(quarters, quarters_there);
  } else {
    // A missing block is replaced by the one above, which is most similar: a target is contiguous.
    light = row > 0 ? light_[place(column, row - 1)] : 0.0;
  }
}

void TargetFinder::average_blocks(const imaging::ImageView& image, const DetectorLevels& levels) {
  columns_ = (image.frame.width + kBlock - 1) / kBlock;
  rows_ = (image.frame.height + kBlock - 1) / kBlock;
  pixels_there_ = 0;
  saturated_ = 0;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) average_block(image, levels, column, row);
  }
}

/// The level below which this share of the blocks lies, to 0.01 DN.
double TargetFinder::level_below(double share) const {
  const int blocks = columns_ * rows_;
  double low = -4096.0;
  double high = 65536.0;
  for (int k = 0; k < 24; ++k) {
    const double middle = 0.5 * (low + high);
    int below = 0;
    for (int b = 0; b < blocks; ++b) below += light_[static_cast<std::size_t>(b)] < middle ? 1 : 0;
    if (below < share * blocks) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return high;
}

TargetFinder::Structure TargetFinder::grow_from(int column, int row) {
  Structure structure{column, column, row, row, 0, 0};
  std::size_t waiting = 0;
  is_open_[place(column, row)] = false;
  to_visit_[waiting++] = static_cast<std::int16_t>(place(column, row));
  while (waiting > 0) {  // a block is queued at most once
    const int block = to_visit_[--waiting];
    const int x = block % columns_;
    const int y = block / columns_;
    structure.left = smaller(structure.left, x);
    structure.right = larger(structure.right, x);
    structure.top = smaller(structure.top, y);
    structure.bottom = larger(structure.bottom, y);
    ++structure.blocks;
    if (x == 0 || y == 0 || x == columns_ - 1 || y == rows_ - 1) ++structure.at_edge;
    for (int v = larger(0, y - kReach); v <= smaller(rows_ - 1, y + kReach); ++v) {
      for (int u = larger(0, x - kReach); u <= smaller(columns_ - 1, x + kReach); ++u) {
        if (!is_open_[place(u, v)]) continue;
        is_open_[place(u, v)] = false;
        to_visit_[waiting++] = static_cast<std::int16_t>(place(u, v));
      }
    }
  }
  return structure;
}

bool TargetFinder::is_like_target(const Structure& structure) const {
  const int width = structure.right - structure.left + 1;
  const int height = structure.bottom - structure.top + 1;
  const int side = larger(width, height);
  return structure.blocks >= kMinBlocks && side >= kMinSide && side <= kMaxSide &&
         structure.at_edge <= kMaxAtEdge * side && structure.blocks >= kMinFilled * width * height;
}

bool TargetFinder::find_above(double level, Structure& best) {
  const int blocks = columns_ * rows_;
  for (int b = 0; b < blocks; ++b) {
    is_open_[static_cast<std::size_t>(b)] = light_[static_cast<std::size_t>(b)] > level;
  }
  best = {};
  is_large_ = false;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (!is_open_[place(column, row)]) continue;
      const Structure structure = grow_from(column, row);
      if (structure.blocks >= kMinLit) is_large_ = true;
      if (structure.blocks > best.blocks && is_like_target(structure)) best = structure;
    }
  }
  return best.blocks > 0;
}

CropRegion TargetFinder::region_around(const Structure& structure, const imaging::ImageFrame& frame) const {
  const int width = kBlock * (structure.right - structure.left + 1);
  const int height = kBlock * (structure.bottom - structure.top + 1);
  CropRegion region;
  region.centre_px = {frame.origin_x + kBlock * structure.left + 0.5 * (width - 1),
                      frame.origin_y + kBlock * structure.top + 0.5 * (height - 1)};
  region.side_px = kMargin * larger(width, height);
  return region;
}

Finding TargetFinder::find(const imaging::ImageView& image, const DetectorLevels& levels) {
  const imaging::ImageFrame& frame = image.frame;
  const bool is_image =
      frame.width > 0 && frame.height > 0 && frame.width <= imaging::kMaxSide && frame.height <= imaging::kMaxSide &&
      static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height) == image.pixels.size() &&
      image.pixels.size() <= imaging::kMaxPixels;
  if (!is_image || !(levels.noise_dn > 0.0) || !math::is_finite(levels.dark_level_dn + levels.noise_dn)) {
    return Finding::kNothing;
  }
  average_blocks(image, levels);
  if (saturated_ > kMaxSaturated * pixels_there_) return Finding::kBlinded;

  // A quarter of the blocks are dark even beside a target that fills the image. From the 5 % to the 25 % point is one
  // sigma of blocks of noise; 32 pixels are in the middle of four quarters.
  const double background = level_below(0.25);
  const double expected = levels.noise_dn / math::sqrt(32.0);
  const double scatter = background - level_below(0.05);
  double above = kNoises * (scatter > expected ? scatter : expected);
  bool is_light = background > levels.noise_dn;
  for (int k = 0; k < kMaxLevels; ++k) {
    Structure best;
    if (find_above(background + above, best)) {
      region_ = region_around(best, frame);
      return Finding::kTarget;
    }
    is_light = is_light || is_large_;
    above *= kLevelFactor;
  }
  return is_light ? Finding::kNothing : Finding::kDark;
}

}  // namespace vbar::fsw::pose
