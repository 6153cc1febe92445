#include "fsw/gnc/camera_pointing.h"

#include <Eigen/Geometry>

#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
namespace {

/// The state of `epoch` at `time`, not before it.
Result<orbit::CartesianState> flown(orbit::CartesianState state, GpsTime epoch, GpsTime time,
                                    std::span<const navigation::Burn> burns) {
  for (const navigation::Burn& burn : burns) {
    if (burn.time < epoch || burn.time >= time) continue;
    const Result<orbit::CartesianState> coasted = orbit::propagate_j2(state, seconds(burn.time - epoch));
    if (!coasted.ok()) return coasted.status();
    state = orbit::apply_impulse_rtn(coasted.value(), burn.dv_rtn);
    epoch = burn.time;
  }
  return orbit::propagate_j2(state, seconds(time - epoch));
}

}  // namespace

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

std::optional<orbit::CartesianState> servicer_at(GpsTime time, const navigation::GnssNavigation& own_orbit,
                                                 std::span<const navigation::Burn> burns) {
  if (!own_orbit.has_servicer() || own_orbit.epoch() > time) return std::nullopt;
  const auto servicer = flown(own_orbit.servicer(), own_orbit.epoch(), time, burns);
  if (!servicer.ok()) return std::nullopt;
  return servicer.value();
}

}  // namespace vbar::fsw::gnc
