#include "fsw/navigation/attitude_history.h"

#include "fsw/math/math.h"

namespace vbar::fsw::navigation {
namespace {

Duration distance(GpsTime a, GpsTime b) {
  return a < b ? b - a : a - b;
}

/// Rodrigues's rotation by the vector `angle` (rad).
Matrix3 rotation(const Vector3& angle) {
  const double size = angle.norm();
  if (size < 1e-12) return Matrix3::Identity();
  const Vector3 axis = angle / size;
  Matrix3 cross;
  cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  return Matrix3::Identity() + math::sin(size) * cross + (1.0 - math::cos(size)) * (cross * cross);
}

}  // namespace

Matrix3 rotated(const Matrix3& R_eci_body, const Vector3& angle_body) {
  return R_eci_body * rotation(angle_body);
}

void AttitudeHistory::put(const AttitudeSample& sample) {
  samples_[next_] = sample;
  next_ = (next_ + 1) % kSamples;
  if (count_ < kSamples) ++count_;
}

std::optional<Matrix3> AttitudeHistory::R_eci_body_at(GpsTime time) const {
  const AttitudeSample* nearest = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    if (nearest == nullptr || distance(samples_[k].time, time) < distance(nearest->time, time)) nearest = &samples_[k];
  }
  if (nearest == nullptr || distance(nearest->time, time) > kReach) return std::nullopt;
  return rotated(nearest->R_eci_body, seconds(time - nearest->time) * nearest->rate_body);
}

}  // namespace vbar::fsw::navigation
