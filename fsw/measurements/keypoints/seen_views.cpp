#include "fsw/measurements/keypoints/seen_views.h"

#include "fsw/math/math.h"

namespace vbar::fsw::measurements {

double distance(const View& a, const View& b) {
  const Eigen::Quaterniond between = a.q_camera_body.conjugate() * b.q_camera_body;
  const double angle = 2.0 * math::atan2(math::sqrt(between.vec().squaredNorm()), math::abs(between.w()));
  return math::hypot(angle, a.log_range - b.log_range);
}

void ViewNovelty::clear() {
  count_ = 0;
  recent_count_ = 0;
}

double ViewNovelty::faded(const Seen& seen, GpsTime time) const {
  return seen.count * math::exp(-seconds(time - seen.time) / settings_.memory_s);
}

double ViewNovelty::scale(const View& view, GpsTime time) const {
  double sum = 0.0;
  const auto weigh = [&](const Seen& seen) {
    sum += faded(seen, time) * math::exp(-distance(seen.view, view) / settings_.angle);
  };
  for (std::size_t k = 0; k < count_; ++k) weigh(views_[k]);
  for (std::size_t k = 0; k < recent_count_; ++k) {
    if (seconds(time - recent_[k].time) > settings_.left_out_s) weigh(recent_[k]);
  }
  const double scale = 1.0 + settings_.gain * sum;
  return math::is_finite(scale) ? scale : 1.0;
}

void ViewNovelty::add(const View& view, GpsTime time) {
  if (!math::is_finite(view.q_camera_body.coeffs().sum() + view.log_range)) return;
  for (std::size_t k = 0; k < kMaxRecent && recent_count_ > 0; ++k) {
    if (seconds(time - recent_[0].time) <= settings_.left_out_s) break;
    keep(recent_[0]);
    drop_oldest_recent();
  }
  if (recent_count_ == kMaxRecent) {
    keep(recent_[0]);
    drop_oldest_recent();
  }
  recent_[recent_count_++] = {view, 1.0, time};
}

void ViewNovelty::drop_oldest_recent() {
  --recent_count_;
  for (std::size_t k = 0; k < recent_count_; ++k) recent_[k] = recent_[k + 1];
}

/// Into the nearest view, or as a new one in place of the one with the smallest count.
void ViewNovelty::keep(const Seen& seen) {
  std::size_t nearest = kMaxViews;
  double nearest_distance = settings_.merged_angle;
  std::size_t least = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    const double apart = distance(views_[k].view, seen.view);
    if (apart < nearest_distance) {
      nearest = k;
      nearest_distance = apart;
    }
    if (faded(views_[k], seen.time) < faded(views_[least], seen.time)) least = k;
  }
  if (nearest < kMaxViews) {
    views_[nearest].count = faded(views_[nearest], seen.time) + seen.count;
    views_[nearest].time = seen.time;
  } else {
    views_[count_ < kMaxViews ? count_++ : least] = seen;
  }
}

}  // namespace vbar::fsw::measurements
