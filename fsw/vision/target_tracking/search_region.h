#pragma once
// Where a target is searched that is lit and not found where navigation predicts it: the errors of the prediction may
// be larger than stated. With the number of images without it the predicted bearing and its rates are given a growing
// standard deviation, until the region is the field of view.

#include <array>
#include <cstddef>

#include "fsw/vision/target_tracking/prediction.h"

namespace vbar::fsw::target_tracking {

class SearchRegion {
 public:
  /// Notes an image. `is_expected`: the target should be in it; `is_tracked`: an object was taken for it; `is_used`:
  /// and its bearing agreed with the estimated orbit, which ends the search. While an object is tracked the region
  /// neither grows nor shrinks. A target that was never seen is searched within the errors of the a-priori orbit.
  void note(bool is_expected, bool is_tracked, bool is_used) {
    if (is_used) {
      images_ = 0;
      has_been_seen_ = true;
    } else if (has_been_seen_ && is_expected && !is_tracked && images_ < kImages) {
      ++images_;
    }
  }

  [[nodiscard]] bool is_widened() const { return images_ > kPatience; }
  /// Standard deviation added to each component of the bearing, rad.
  [[nodiscard]] double sigma() const {
    double sigma = is_widened() ? kFirst : 0.0;
    for (int k = kPatience + kPerStep; k < images_; k += kPerStep) sigma *= 2.0;
    return sigma < kLargest ? sigma : kLargest;
  }
  /// Direction in which the camera points meanwhile, off the prediction: rad, along R and N. Once the region exceeds
  /// the field of view, its middle and eight directions about it, the middle before each of them: a target that was
  /// hidden is where it is predicted.
  [[nodiscard]] Vector2 scan_offset() const {
    if (images_ < kScanFrom) return Vector2::Zero();
    const std::size_t step = static_cast<std::size_t>((images_ - kScanFrom) / kScanImages);
    if (step % 2 == 0) return Vector2::Zero();
    const std::array<double, 2>& direction = kScan[step / 2 % kScan.size()];
    return kScanStep * Vector2(direction[0], direction[1]);
  }
  /// The prediction with this error; as it is before the region grows.
  [[nodiscard]] Prediction widened(const Prediction& prediction, double mean_motion) const;

  static constexpr int kPatience = 10;  ///< images: tracks are established and resume within fewer
  static constexpr int kPerStep = 3;    ///< images, before the region doubles
  static constexpr double kFirst = 2e-4;
  static constexpr double kLargest = 0.05;   ///< the gate of 4.3 sigma then exceeds any field of view
  static constexpr int kScanFrom = 45;       ///< images
  static constexpr int kScanImages = 7;      ///< of one direction: enough to establish a track
  static constexpr double kScanStep = 0.06;  ///< rad: less than the shorter side of the field

 private:
  static constexpr std::array<std::array<double, 2>, 8> kScan{
      {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}};
  static constexpr int kImages = 100000;
  bool has_been_seen_ = false;
  int images_ = 0;  ///< without the target, though expected
};

}  // namespace vbar::fsw::target_tracking
