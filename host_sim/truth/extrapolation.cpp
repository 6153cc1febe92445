#include "host_sim/truth/extrapolation.h"

namespace vbar::truth {

using fsw::Vector3;

Vector3 central_acceleration(double gm, const Vector3& position_eci) {
  const double r = position_eci.norm();
  return -gm / (r * r * r) * position_eci;
}

fsw::orbit::CartesianState orbit_ahead(const fsw::orbit::CartesianState& state, double gm,
                                       const Vector3& perturbation_eci, double seconds) {
  const auto acceleration = [&](const Vector3& r) -> Vector3 { return central_acceleration(gm, r) + perturbation_eci; };
  const double h = seconds;
  const Vector3 &r = state.position_eci, &v = state.velocity_eci;
  const Vector3 a1 = acceleration(r);
  const Vector3 a2 = acceleration(r + h / 2.0 * v);
  const Vector3 a3 = acceleration(r + h / 2.0 * v + h * h / 4.0 * a1);
  const Vector3 a4 = acceleration(r + h * v + h * h / 2.0 * a2);
  fsw::orbit::CartesianState ahead;
  ahead.position_eci = r + h * v + h * h / 6.0 * (a1 + a2 + a3);
  ahead.velocity_eci = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  return ahead;
}

AttitudeState attitude_ahead(AttitudeState attitude, const Vector3& angular_acceleration_body, double seconds) {
  const Vector3 turn = seconds * attitude.rate_body + 0.5 * seconds * seconds * angular_acceleration_body;
  const double angle = turn.norm();
  if (angle > 0.0)
    attitude.q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(-angle, turn / angle)) * attitude.q_body_eci;
  attitude.rate_body += seconds * angular_acceleration_body;
  return attitude;
}

}  // namespace vbar::truth
