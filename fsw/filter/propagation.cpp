#include "fsw/filter/propagation.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::filter {
namespace {

constexpr double kMaxStep_s = 20.0;
constexpr int kMaxSteps = static_cast<int>(Propagation::kLongest / kMaxStep_s);

orbit::CartesianState moved(const orbit::CartesianState& s, double h, const Vector3& velocity, const Vector3& rate) {
  return {.position_eci = s.position_eci + h * velocity, .velocity_eci = s.velocity_eci + h * rate};
}

}  // namespace

Propagation::Propagation(GpsTime start, const orbit::EarthOrientation& earth, const Vector3& sun_eci)
    : R_itrf_gcrf_(orbit::R_itrf_gcrf(start, earth)), sun_eci_(sun_eci) {}

/// The air rotates with the Earth. Across the orbit its wind alternates with every revolution, in resonance with the
/// relative inclination: at 51.6 deg and 400 km a differential drag of 1e-6 m/s^2 shifts the plane by 0.1 m in one.
Vector3 Propagation::through_air(const orbit::CartesianState& s) const {
  const Vector3 earth_rate = orbit::kEarthRotationRate * R_itrf_gcrf_.row(2).transpose();
  return s.velocity_eci - earth_rate.cross(s.position_eci);
}

/// Within two hours the Earth's rotation is a constant rate: its pole moves by less than 1e-9 rad.
Vector3 Propagation::acceleration(const orbit::CartesianState& s, double after,
                                  const DifferentialAcceleration& differential) const {
  const double angle = orbit::kEarthRotationRate * after;
  const double c = math::cos(angle);
  const double sn = math::sin(angle);
  const Vector3 start_itrf = R_itrf_gcrf_ * s.position_eci;
  const Vector3 position_itrf(c * start_itrf.x() + sn * start_itrf.y(), c * start_itrf.y() - sn * start_itrf.x(),
                              start_itrf.z());
  const Vector3 g = orbit::gravity_itrf(position_itrf);
  Vector3 a = R_itrf_gcrf_.transpose() * Vector3(c * g.x() - sn * g.y(), c * g.y() + sn * g.x(), g.z());
  if (!differential.empirical_rtn.isZero(0.0)) a += orbit::R_rtn_eci(s).transpose() * differential.empirical_rtn;
  if (differential.drag != 0.0) a += differential.drag * through_air(s).normalized();
  if (differential.from_sun != 0.0 && is_sunlit(s.position_eci, sun_eci_)) a -= differential.from_sun * sun_eci_;
  return a;
}

orbit::CartesianState Propagation::coast(const orbit::CartesianState& state, double dt,
                                         const DifferentialAcceleration& differential) const {
  if (dt == 0.0) return state;
  const double span = dt > kLongest ? kLongest : dt < -kLongest ? -kLongest : dt;
  int steps = 1;
  while (steps < kMaxSteps && math::abs(span) > steps * kMaxStep_s) ++steps;
  const double h = span / steps;
  orbit::CartesianState s = state;
  for (int k = 0; k < steps; ++k) {
    const double t = k * h;
    const Vector3 a1 = acceleration(s, t, differential);
    const orbit::CartesianState s2 = moved(s, 0.5 * h, s.velocity_eci, a1);
    const Vector3 a2 = acceleration(s2, t + 0.5 * h, differential);
    const orbit::CartesianState s3 = moved(s, 0.5 * h, s2.velocity_eci, a2);
    const Vector3 a3 = acceleration(s3, t + 0.5 * h, differential);
    const orbit::CartesianState s4 = moved(s, h, s3.velocity_eci, a3);
    const Vector3 a4 = acceleration(s4, t + h, differential);
    s.position_eci += h / 6.0 * (s.velocity_eci + 2.0 * s2.velocity_eci + 2.0 * s3.velocity_eci + s4.velocity_eci);
    s.velocity_eci += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return s;
}

bool is_sunlit(const Vector3& position_eci, const Vector3& sun_eci) {
  const double towards = position_eci.dot(sun_eci);
  return towards > 0.0 || (position_eci - towards * sun_eci).squaredNorm() > orbit::kEarthRadius * orbit::kEarthRadius;
}

namespace {

constexpr double kMaxStepJ2_s = 10.0;
constexpr int kMaxStepsJ2 = 360;

Vector3 acceleration(const orbit::CartesianState& s, const Vector3& acceleration_rtn) {
  return orbit::acceleration_j2(s.position_eci) + orbit::R_rtn_eci(s).transpose() * acceleration_rtn;
}

}  // namespace

orbit::CartesianState propagate_accelerated(const orbit::CartesianState& state, const Vector3& acceleration_rtn,
                                            double dt) {
  int steps = 1;
  while (steps < kMaxStepsJ2 && math::abs(dt) > steps * kMaxStepJ2_s) ++steps;
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
