#pragma once
// Object detection: components above the background are assembled and measured. Stars, satellites and hot pixels are
// all alike here; objects larger than any satellite (Earth, Moon, glare of the Sun) are counted and ignored.
//
// Sums of 3 x 3 pixels are compared with the background's level and noise: for the image of a point nearly as good as a
// matched filter, in integers. Results are bit-identical on every target.

#include <array>
#include <cstdint>
#include <span>

#include "fsw/vision/imaging/background.h"
#include "fsw/vision/imaging/centroid.h"
#include "fsw/vision/imaging/components.h"
#include "fsw/vision/imaging/image.h"

namespace vbar::fsw::imaging {

struct DetectorSettings {
  double detection_sigmas = 5.0;  ///< sigmas of a sum of 3 x 3 pixels, 1 to 30; 5: a false object in ten images
  double gain_dn_per_electron = 0.125;
  int saturation_dn = 4000;            ///< a pixel of this value or more is saturated, 1 to 4095
  double point_spread_sigma_px = 0.8;  ///< sigma of the image of a point, before the pixel's own width, 0.3 to 3
  int largest_object_px = 20000;       ///< pixels
};

struct DetectionReport {
  ImageCondition condition = ImageCondition::kInvalid;  ///< no object unless kGood
  double background_dn = 0.0;                           ///< median over the image
  double noise_dn = 0.0;                                ///< 1 sigma of a pixel, median over the image
  int components = 0;                                   ///< all components found
  int objects = 0;                                      ///< measured and reported
  int extended = 0;                                     ///< components larger than largest_object_px
  int pixels_rejected = 0;                              ///< pixels of the extended components
  int fragments = 0;                                    ///< components that are parts of a bright halo: not reported
  int runs_dropped = 0;                                 ///< not 0: a row had too many runs to be processed
};

/// Detects and measures the objects of an image. Its 300 kB are workspace: no information is kept between images.
///
/// A point that is neither saturated nor at an edge is measured by windowed_centroid() of centroid.h, also if two
/// points touch. Objects that are saturated or wider are measured by the intensity-weighted mean of all their pixels:
/// for a saturated point the accuracy is limited by rounding of the bright disc's edge to pixels, 0.06 px, which its
/// sigma excludes.
class ObjectDetector {
 public:
  /// Searches the complete image, without a preferred position.
  DetectionReport detect(const ImageView& image, const DetectorSettings& settings);

  /// Objects of the last image, brightest first, in detector coordinates: the image's origin is added.
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
  void add_object(const Component& component, const Centroid& centroid, double radius_px);
  [[nodiscard]] const std::uint16_t* image_row(int y) const {
    return image_.pixels.data() + static_cast<std::ptrdiff_t>(y) * image_.frame.width;
  }

  Background background_;
  Components components_;
  std::array<DetectedObject, kMaxObjects> objects_{};
  std::size_t object_count_ = 0;

  // Data of the current image
  ImageView image_;
  DetectorSettings settings_;
  int noises_q4_ = 0;  ///< threshold above the background of nine pixels, in sigmas of one / 16

  // Data of the current row
  std::array<const std::uint16_t*, 3> rows_{};  ///< above, this, below
  std::array<std::array<std::uint16_t, kMaxSide>, 3> patched_{};
  bool is_patched_ = false;
  std::array<int, kMaxSide> threshold_dn_{};
  std::array<Run, Components::kMaxRunsOfRow> runs_{};
  std::size_t run_count_ = 0;
  int runs_dropped_ = 0;  ///< since the start of the image
  Background::RowNodes level_{};
};

}  // namespace vbar::fsw::imaging
