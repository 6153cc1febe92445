#include "fsw/orbit/rtn.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::orbit {
namespace {

Result<CartesianState> cartesian_from_mean(const QnsElements& mean) {
  const Result<QnsElements> osculating = osculating_from_mean(mean);
  if (!osculating.ok()) return osculating.status();
  return cartesian_from_qns(osculating.value());
}

}  // namespace

Matrix3 R_rtn_eci(const CartesianState& state) {
  const Vector3& r = state.position_eci;
  const Vector3 h = r.cross(state.velocity_eci);
  const Vector3 radial = r / math::sqrt(r.squaredNorm());
  const Vector3 normal = h / math::sqrt(h.squaredNorm());
  Matrix3 rotation;
  rotation.row(0) = radial;
  rotation.row(1) = normal.cross(radial);
  rotation.row(2) = normal;
  return rotation;
}

RelativeState relative_state_rtn(const CartesianState& chief, const CartesianState& deputy) {
  const Matrix3 rotation = R_rtn_eci(chief);
  const Vector3& r = chief.position_eci;
  const double rate = math::sqrt(r.cross(chief.velocity_eci).squaredNorm()) / r.squaredNorm();
  RelativeState relative;
  relative.position_rtn = rotation * (deputy.position_eci - r);
  const Vector3 inertial_velocity_rtn = rotation * (deputy.velocity_eci - chief.velocity_eci);
  relative.velocity_rtn = inertial_velocity_rtn - Vector3(0.0, 0.0, rate).cross(relative.position_rtn);
  return relative;
}

CartesianState apply_impulse_rtn(const CartesianState& state, const Vector3& dv_rtn) {
  return CartesianState{.position_eci = state.position_eci,
                        .velocity_eci = state.velocity_eci + R_rtn_eci(state).transpose() * dv_rtn};
}

Result<RelativeState> relative_state_from_mean_roe(const QnsElements& chief_mean, const Vector6& mean_roe) {
  const Result<CartesianState> chief = cartesian_from_mean(chief_mean);
  if (!chief.ok()) return chief.status();
  const Result<CartesianState> deputy = cartesian_from_mean(qns_from_roe(chief_mean, mean_roe));
  if (!deputy.ok()) return deputy.status();
  return relative_state_rtn(chief.value(), deputy.value());
}

}  // namespace vbar::fsw::orbit
