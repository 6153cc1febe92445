#include "host_sim/truth/forces/third_body_force.h"

#include <cmath>

namespace vbar::truth {

fsw::Vector3 third_body_acceleration(const fsw::Vector3& position, const fsw::Vector3& third_body, double gm) {
  // (distance to the third body / its distance from the origin)^2 = 1 + q, and f(q) = (1 + q)^(3/2) - 1.
  const double q = position.dot(position - 2.0 * third_body) / third_body.squaredNorm();
  const double ratio_cubed = (1.0 + q) * std::sqrt(1.0 + q);
  const double f = q * (3.0 + q * (3.0 + q)) / (1.0 + ratio_cubed);
  const double distance = (position - third_body).norm();
  return -gm / (distance * distance * distance) * (position + f * third_body);
}

fsw::Vector3 ThirdBodyForce::acceleration_eci(const ForceInput& input) {
  return body_ == Body::kSun ? third_body_acceleration(input.position_eci, input.sun_eci, kSunGm)
                             : third_body_acceleration(input.position_eci, input.moon_eci, kMoonGm);
}

}  // namespace vbar::truth
