#include "fsw/sources/pointing.h"

#include <Eigen/Geometry>

#include "fsw/orbit/rtn.h"

namespace vbar::fsw::sources {

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

}  // namespace vbar::fsw::sources
