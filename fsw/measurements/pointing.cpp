#include "fsw/measurements/pointing.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::measurements {

Result<Pointing> pointing_at(GpsTime time, const orbit::CartesianState& servicer, const orbit::CartesianState& target) {
  const orbit::RelativeState relative = orbit::relative_state_rtn(servicer, target);
  const double range = relative.position_rtn.norm();
  if (!(range > 1e-3)) return Status::kOutOfRange;
  Pointing pointing;
  pointing.time = time;
  pointing.boresight_rtn = relative.position_rtn / range;
  const Vector3 rate = relative.velocity_rtn / range;
  pointing.boresight_rate_rtn = rate - pointing.boresight_rtn.dot(rate) * pointing.boresight_rtn;
  return pointing;
}

Matrix3 R_body_eci_of(const Pointing& pointing, GpsTime time, const orbit::CartesianState& servicer) {
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const Vector3 z = R_rtn_eci.transpose() * pointing.boresight_rtn_at(time);
  const Vector3 zenith = servicer.position_eci.normalized();
  const Vector3 x = z.cross(zenith).normalized();  // -y to the zenith: x = y cross z
  Matrix3 R_body_eci;
  R_body_eci.row(0) = x.transpose();
  R_body_eci.row(1) = z.cross(x).transpose();
  R_body_eci.row(2) = z.transpose();
  return R_body_eci;
}

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

}  // namespace vbar::fsw::measurements
