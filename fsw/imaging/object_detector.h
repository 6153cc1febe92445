#pragma once
// Objects in an image: what exceeds the background, put together and measured. Stars, satellites and hot pixels are all
// alike here; what is larger than any satellite can be (Earth, Moon, the Sun's glare) is counted and left alone.
//
// Sums of 3 x 3 pixels are compared with the background's level and noise: for the image of a point nearly as good as a
// filter matched to it, in whole numbers. Results are the same bits on every target.

#include <array>
#include <cstdint>
#include <span>

#include "fsw/imaging/background.h"
#include "fsw/imaging/blend.h"
#include "fsw/imaging/centroid.h"
#include "fsw/imaging/components.h"
#include "fsw/imaging/detected_object.h"
#include "fsw/imaging/image.h"

namespace vbar::fsw::imaging {

struct DetectorSettings {
  double detection_sigmas = 5.0;  ///< of the noise of a sum of 3 x 3 pixels, 1 to 30. 5: a false object in ten images
  double gain_dn_per_electron = 0.125;
  int saturation_dn = 4000;            ///< a pixel of so much says no more than that it is bright, 1 to 4095
  double point_spread_sigma_px = 0.8;  ///< of the image of a point, before the pixel's own width, 0.3 to 3
  int largest_object_px = 20000;       ///< pixels
};

struct DetectionReport {
  ImageCondition condition = ImageCondition::kInvalid;  ///< no object unless kGood
  double background_dn = 0.0;                           ///< median over the image
  double noise_dn = 0.0;                                ///< 1 sigma of a pixel, median over the image
  int components = 0;                                   ///< all that was found
  int objects = 0;                                      ///< measured and told
  int extended = 0;                                     ///< of the components, larger than largest_object_px
  int pixels_rejected = 0;                              ///< of the extended ones
  int fragments = 0;                                    ///< of the components, bits of a bright object's halo: not told
  int runs_dropped = 0;                                 ///< not 0: a row so full that it was not read to its end
};

/// Some 300 kB, all of it work space: nothing of an image matters to the next.
///
/// A point that is neither saturated nor at an edge gets the centroid of centroid.h, windowed_centroid(); two that
/// touch do so each. Whatever is saturated or wider gets the intensity-weighted mean of all its pixels: of a saturated
/// point that is as good as the rounding of the bright disc's edge to whole pixels lets it be, 0.06 px, which its sigma
/// leaves out.
class ObjectDetector {
 public:
  /// Looks at the whole image with no preference for any place in it.
  DetectionReport detect(const ImageView& image, const DetectorSettings& settings);

  /// Of the last image, brightest first. On the detector: the image's origin is added.
  [[nodiscard]] std::span<const DetectedObject> objects() const { return std::span(objects_).first(object_count_); }

 private:
  struct Run {
    std::int16_t begin = 0;
    std::int16_t end = 0;
  };

  void find_components();
  [[nodiscard]] bool scan_row();
  void push_run(int begin, int end);
  void patch_rows(int y);
  void add_run(int y, const Run& run);
  void add_pixels(Component& component, int y, const Run& run);
  [[nodiscard]] int sum_around(int x) const;
  [[nodiscard]] bool touches_missing(int y, const Run& run) const;
  [[nodiscard]] bool is_fragment(std::size_t k) const;
  void measure(const Component& component);
  void measure_whole(const Component& component);
  [[nodiscard]] bool measure_points(const Component& component, const Blend& blend);
  [[nodiscard]] int brightest_around(int x, int y) const;
  void tell(const Component& component, const Centroid& centroid, double radius_px);
  [[nodiscard]] const std::uint16_t* image_row(int y) const {
    return image_.pixels.data() + static_cast<std::ptrdiff_t>(y) * image_.frame.width;
  }

  Background background_;
  Components components_;
  std::array<DetectedObject, kMaxObjects> objects_{};
  std::size_t object_count_ = 0;

  // Of the image in work
  ImageView image_;
  DetectorSettings settings_;
  int noises_q4_ = 0;  ///< threshold above the background of nine pixels, in sigmas of one / 16

  // Of the row in work
  std::array<const std::uint16_t*, 3> rows_{};  ///< above, this, below
  std::array<std::array<std::uint16_t, kMaxSide>, 3> patched_{};
  bool is_patched_ = false;
  std::array<int, kMaxSide> threshold_dn_{};
  std::array<Run, Components::kMaxRunsOfRow> runs_{};
  std::size_t run_count_ = 0;
  int runs_dropped_ = 0;  ///< since the image began
  Background::RowNodes level_{};
};

}  // namespace vbar::fsw::imaging
