#pragma once
// Connected components of the pixels above a threshold, in one pass over the image: runs of a row are joined with those
// of the previous row by union and find, and a component that the next row does not continue is complete (the one-pass
// method of Bailey and Johnston 2007). Memory is therefore bounded by a row and not by the image.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/types.h"
#include "fsw/vision/imaging/background.h"

namespace vbar::fsw::imaging {

// Objects found by image processing: stars, satellites, hot pixels, not yet distinguished.

inline constexpr std::size_t kMaxObjects = 256;

struct DetectedObject {
  Vector2 centroid_px = Vector2::Zero();  ///< mean of brightness, on the detector; an integer is a pixel's centre
  double sigma_px = 0.0;                  ///< 1 sigma of the centroid, each axis, by photon and read noise
  double flux_dn = 0.0;                   ///< above the background, all its pixels
  int peak_dn = 0;                        ///< brightest pixel, background included
  int pixels = 0;                         ///< above the threshold
  /// Share of the light in the brightest pixel: a quarter at most for a point in focus, nearly all for a hot pixel.
  double sharpness = 0.0;
  double radius_px = 0.0;     ///< root of the larger eigenvalue of its second moments
  bool is_saturated = false;  ///< at least one pixel is saturated
  bool is_cut = false;        ///< the object touches the edge of the image or a missing pixel
};

/// Connected pixels, with brightness above the background in DN / 16 and coordinates from the image's first pixel.
struct Component {
  int pixels = 0;
  int x_min = 0, x_max = 0, y_min = 0, y_max = 0;
  int peak_dn = 0;   ///< brightest pixel
  int peak_sum = 0;  ///< brightest neighbourhood of 3 x 3 pixels, DN, and its middle
  int peak_x = 0, peak_y = 0;
  bool is_saturated = false;
  bool is_cut = false;
  std::int64_t x = 0, y = 0, xx = 0, yy = 0;  ///< sums over the pixels
  std::int64_t flux = 0, flux_x = 0, flux_y = 0, flux_xx = 0, flux_xy = 0, flux_yy = 0;
};

/// Order of components: brightest first; equally bright ones from the top and from the left.
bool is_brighter(const Component& a, const Component& b);

class Components {
 public:
  static constexpr std::size_t kMaxRunsOfRow = 512;

  /// Prepares for an image. Components of more than `largest_px` pixels are extended: counted, not kept.
  void clear(int largest_px);

  /// Adds the next run of row y, pixels begin to end - 1; rows from the top, runs from the left. Returns its component
  /// so far, to which the caller adds the run's pixels; null if the row has too many runs.
  Component* add_run(int y, int begin, int end);
  /// Ends row y.
  void end_row(int y);
  /// Ends the image and sorts the components kept.
  void finish();

  /// Components after finish(): at most kMaxObjects, the brightest of all.
  [[nodiscard]] std::span<const Component> kept() const { return std::span(kept_).first(kept_count_); }

  [[nodiscard]] int found() const { return found_; }  ///< extended ones included
  [[nodiscard]] int extended() const { return extended_; }
  [[nodiscard]] int extended_pixels() const { return extended_pixels_; }
  [[nodiscard]] int runs_dropped() const { return runs_dropped_; }
  [[nodiscard]] bool is_extended(const Component& component) const { return component.pixels > largest_px_; }

 private:
  using Label = std::int16_t;
  struct Run {
    std::int16_t begin = 0;
    std::int16_t end = 0;
    Label label = 0;
  };
  /// Each run of two rows may have a label of its own.
  static constexpr std::size_t kMaxLabels = 2 * kMaxRunsOfRow;

  [[nodiscard]] Label root_of(Label label) const;
  [[nodiscard]] Label new_label(int y, int begin, int end);
  void unite(Label into, Label from);
  void release(Label label) { free_[free_count_++] = label; }
  void close(const Component& component);
  void keep_brightest();
  [[nodiscard]] Component& component(Label label) { return components_[static_cast<std::size_t>(label)]; }

  int largest_px_ = 0;
  std::array<std::array<Run, kMaxRunsOfRow>, 2> runs_{};  ///< runs of this row and of the previous one
  std::array<std::size_t, 2> run_count_{};
  std::size_t now_ = 0;     ///< which of the two is this row
  std::size_t before_ = 0;  ///< first run of the previous row that a later run of this one may touch
  std::array<Component, kMaxLabels> components_{};
  std::array<Label, kMaxLabels> parent_{};
  std::array<Label, kMaxLabels> free_{};
  std::size_t free_count_ = 0;
  std::array<Label, kMaxLabels> united_{};  ///< labels of this row that were merged into another
  std::size_t united_count_ = 0;
  std::array<Component, 2 * kMaxObjects> kept_{};
  std::size_t kept_count_ = 0;
  std::int64_t min_flux_ = 0;  ///< components fainter than this are not among the brightest
  int found_ = 0;
  int extended_ = 0;
  int extended_pixels_ = 0;
  int runs_dropped_ = 0;
};

// Deblending: two or more points of light in one component, separated if there is a minimum between them.

struct Blend {
  static constexpr std::size_t kMaxPeaks = 4;
  struct Peak {
    int x = 0;  ///< px, from the image's first pixel
    int y = 0;
    int sum_dn = 0;  ///< sum of the 3 x 3 pixels around, above the background
  };
  std::array<Peak, kMaxPeaks> peaks{};  ///< brightest first
  std::size_t count = 0;
};

/// Returns the maxima of sums of 3 x 3 pixels within the component. Each exceeds the minimum on the straight path to
/// every brighter one by four times the noise of that difference. The path itself exceeds the background by
/// `detection_sigmas`; otherwise it leads to another component. At most kMaxPeaks, the brightest, are returned; 1 for a
/// component of one point.
Blend separate(const ImageView& image, const Background& background, const Component& component,
               double gain_dn_per_electron, double detection_sigmas);

}  // namespace vbar::fsw::imaging
