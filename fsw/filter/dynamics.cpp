#include "fsw/filter/dynamics.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::filter {
namespace {

constexpr double kMaxStep_s = 10.0;
constexpr int kMaxSteps = 360;

Vector3 acceleration(const orbit::CartesianState& s, const Vector3& acceleration_rtn) {
  return orbit::acceleration_j2(s.position_eci) + orbit::R_rtn_eci(s).transpose() * acceleration_rtn;
}

orbit::CartesianState moved(const orbit::CartesianState& s, double h, const Vector3& velocity, const Vector3& rate) {
  return {.position_eci = s.position_eci + h * velocity, .velocity_eci = s.velocity_eci + h * rate};
}

}  // namespace

orbit::CartesianState propagate_accelerated(const orbit::CartesianState& state, const Vector3& acceleration_rtn,
                                            double dt) {
  int steps = 1;
  while (steps < kMaxSteps && math::abs(dt) > steps * kMaxStep_s) ++steps;
  const double h = dt / steps;
  orbit::CartesianState s = state;
  for (int k = 0; k < steps; ++k) {
    const Vector3 a1 = acceleration(s, acceleration_rtn);
    const orbit::CartesianState s2 = moved(s, 0.5 * h, s.velocity_eci, a1);
    const Vector3 a2 = acceleration(s2, acceleration_rtn);
    const orbit::CartesianState s3 = moved(s, 0.5 * h, s2.velocity_eci, a2);
    const Vector3 a3 = acceleration(s3, acceleration_rtn);
    const orbit::CartesianState s4 = moved(s, h, s3.velocity_eci, a3);
    const Vector3 a4 = acceleration(s4, acceleration_rtn);
    s.position_eci += h / 6.0 * (s.velocity_eci + 2.0 * s2.velocity_eci + 2.0 * s3.velocity_eci + s4.velocity_eci);
    s.velocity_eci += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return s;
}

}  // namespace vbar::fsw::filter
