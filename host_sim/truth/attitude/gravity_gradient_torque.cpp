#include "host_sim/truth/attitude/gravity_gradient_torque.h"

namespace vbar::truth {

fsw::Vector3 GravityGradientTorque::torque_body(const ForceInput& orbit, const AttitudeState& attitude) {
  const double r = orbit.position_eci.norm();
  const fsw::Vector3 u = attitude.q_body_eci * (orbit.position_eci / r);
  return 3.0 * gm_ / (r * r * r) * u.cross(inertia_ * u);
}

}  // namespace vbar::truth
