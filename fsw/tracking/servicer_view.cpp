#include "fsw/tracking/servicer_view.h"

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::tracking {

Result<ServicerView> servicer_view(const orbit::CartesianState& servicer) {
  const Result<orbit::QnsElements> elements = orbit::qns_from_cartesian(servicer);
  if (!elements.ok()) return elements.status();
  const Result<orbit::QnsElements> mean = orbit::mean_from_osculating(elements.value());
  if (!mean.ok()) return mean.status();

  const Matrix3 rtn_eci = orbit::R_rtn_eci(servicer);
  const Vector3 velocity_rtn = rtn_eci * servicer.velocity_eci;
  const Vector3 acceleration_rtn = rtn_eci * orbit::acceleration_j2(servicer.position_eci);
  const double radius = math::sqrt(servicer.position_eci.squaredNorm());
  const double radial_speed = velocity_rtn.x();
  const double transverse_speed = velocity_rtn.y();
  // Polar coordinates in the orbital plane: d(v_R)/dt = a_R + v_T^2 / r, d(v_T)/dt = a_T - v_R v_T / r.
  const double radial_rate = acceleration_rtn.x() + transverse_speed * transverse_speed / radius;
  const double transverse_rate = acceleration_rtn.y() - radial_speed * transverse_speed / radius;

  ServicerView view;
  view.latitude = orbit::true_argument_of_latitude(elements.value());
  view.latitude_rate = transverse_speed / radius;
  view.mean_motion = orbit::mean_motion(elements.value().a);
  view.drift_rate = -orbit::roe_transition_j2(mean.value(), 1.0)(1, 0);
  view.semi_major_axis = elements.value().a;
  view.path_slope = radial_speed / transverse_speed;
  view.path_slope_rate = (radial_rate - view.path_slope * transverse_rate) / transverse_speed;
  view.path_stretch_rate = transverse_rate / transverse_speed;
  view.plane_rotation_rate = acceleration_rtn.z() / transverse_speed;
  return view;
}

Result<Vector2> slopes_of(const Vector3& direction_rtn) {
  const double norm = math::sqrt(direction_rtn.squaredNorm());
  if (!math::is_finite(norm)) return Status::kNotFinite;
  if (!(math::abs(direction_rtn.y()) > 0.5 * norm)) return Status::kOutOfRange;
  return Vector2(direction_rtn.x() / direction_rtn.y(), direction_rtn.z() / direction_rtn.y());
}

}  // namespace vbar::fsw::tracking
