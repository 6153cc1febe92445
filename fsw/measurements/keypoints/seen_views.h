#pragma once
// Novelty weight of an image: a network errs alike whenever it sees the same view, so that an image whose view was seen
// before contributes less.
//
// The view is the attitude of the target with respect to the camera, roll included, and the range. Correlation of the
// errors of keypoints at 8 to 12 deg: 0.36 after seconds, 0.36 to 0.48 after revolutions of the target. The covariance
// of its keypoints is multiplied by m = 1 + gain * sum_j c_j exp(-d_j / angle), d_j: distance to a seen view with the
// decaying count c_j.

#include <array>
#include <cstddef>

#include <Eigen/Geometry>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::measurements {

struct NoveltySettings {
  double gain = 0.8;            ///< 0: all images weigh the same
  double angle = 0.25;          ///< rad: distance over which errors decorrelate
  double merged_angle = 0.105;  ///< rad, 6 deg: views closer than this are one
  double memory_s = 2000.0;     ///< counts decay with this time constant
  double left_out_s = 60.0;     ///< views of the latest seconds do not count: the error states model them
};

struct View {
  Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::Identity();
  double log_range = 0.0;  ///< natural logarithm of the range in m: a factor of e^0.25 counts as 0.25 rad
};

/// Returns the distance of two views, rad.
double distance(const View& a, const View& b);

class ViewNovelty {
 public:
  void configure(const NoveltySettings& settings) { settings_ = settings; }
  void clear();

  /// Factor on the covariance of keypoints, 1 or more.
  [[nodiscard]] double scale(const View& view, GpsTime time) const;
  /// The image of this view was used. Views must be added in order of time.
  void add(const View& view, GpsTime time);

  static constexpr std::size_t kMaxViews = 128;
  static constexpr std::size_t kMaxRecent = 32;

 private:
  struct Seen {
    View view;
    double count = 0.0;  ///< at `time`
    GpsTime time;
  };

  void keep(const Seen& seen);
  void drop_oldest_recent();
  [[nodiscard]] double faded(const Seen& seen, GpsTime time) const;

  NoveltySettings settings_;
  std::array<Seen, kMaxViews> views_{};
  std::size_t count_ = 0;
  std::array<Seen, kMaxRecent> recent_{};  ///< of the latest seconds, in order of time
  std::size_t recent_count_ = 0;
};

}  // namespace vbar::fsw::measurements
