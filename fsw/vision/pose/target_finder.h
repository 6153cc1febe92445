#pragma once
// Detection of a large bright structure that may be the target, without a-priori position.
//
// The image is divided into blocks of 8 x 8 px: stars and hot pixels vanish in them, and faint light in shadow is
// detected. Blocks well above the level of the image's darkest part form structures, in which gaps of one block are
// bridged. The largest structure is the target unless it is too small, too large or along the image's edge, as the
// Earth's limb and lateral glare are. If none is acceptable the level is raised: stray light with a gradient across the
// image then breaks up.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/vision/imaging/image.h"
#include "fsw/vision/pose/crop.h"

namespace vbar::fsw::pose {

enum class Finding : std::uint8_t {
  kTarget = 0,
  kNothing,  ///< light, but not that of the target
  kDark,     ///< only noise and specks
  kBlinded,  ///< a larger part of the image is saturated than a target can saturate
};

/// Levels of the detector without light and at saturation.
struct DetectorLevels {
  double dark_level_dn = 64.0;
  double noise_dn = 2.0;  ///< 1 sigma of a pixel
  int saturation_dn = 4000;
};

/// Searches an image for the target. Its 100 kB are workspace.
class TargetFinder {
 public:
  /// Searches an image of width * height pixels. With invalid levels nothing is detected.
  Finding find(const imaging::ImageView& image, const DetectorLevels& levels);

  /// Region of the target after kTarget: the square around it, a margin included.
  [[nodiscard]] const CropRegion& region() const { return region_; }

 private:
  static constexpr int kBlock = 8;  ///< px
  /// Largest number of blocks: (w / 8 + 1) (h / 8 + 1) within kMaxPixels and kMaxSide.
  static constexpr std::size_t kMaxBlocks = 6800;

  /// Extent of a structure in blocks, the last ones included.
  struct Structure {
    int left = 0, right = 0, top = 0, bottom = 0;
    int blocks = 0;
    int at_edge = 0;  ///< its blocks at the image's edge
  };

  void average_blocks(const imaging::ImageView& image, const DetectorLevels& levels);
  void average_block(const imaging::ImageView& image, const DetectorLevels& levels, int column, int row);
  [[nodiscard]] double level_below(double share) const;
  [[nodiscard]] bool find_above(double level, Structure& best);
  [[nodiscard]] Structure grow_from(int column, int row);
  [[nodiscard]] bool is_like_target(const Structure& structure) const;
  [[nodiscard]] CropRegion region_around(const Structure& structure, const imaging::ImageFrame& frame) const;
  [[nodiscard]] std::size_t place(int column, int row) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }

  int columns_ = 0;
  int rows_ = 0;
  int pixels_there_ = 0;
  int saturated_ = 0;
  bool is_large_ = false;                   ///< at the current level, a structure was larger than a speck
  std::array<double, kMaxBlocks> light_{};  ///< above the dark level, DN
  std::array<bool, kMaxBlocks> is_open_{};  ///< above the current level and in no structure yet
  std::array<std::int16_t, kMaxBlocks> to_visit_{};
  CropRegion region_;
};

}  // namespace vbar::fsw::pose
