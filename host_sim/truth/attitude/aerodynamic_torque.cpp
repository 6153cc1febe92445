#include "host_sim/truth/attitude/aerodynamic_torque.h"

#include <stdexcept>
#include <utility>

namespace vbar::truth {

using fsw::Vector3;

namespace {

constexpr double kEarthRate_radps = 7.292115e-5;  // IERS Conventions 2010, table 1.2

}  // namespace

Vector3 velocity_through_air_eci(const ForceInput& orbit) {
  const Vector3 pole_eci = orbit.R_itrf_gcrf.row(2).transpose();
  return orbit.velocity_eci - kEarthRate_radps * pole_eci.cross(orbit.position_eci);
}

AerodynamicTorque::AerodynamicTorque(std::vector<Facet> facets, double drag_coefficient, Density density)
    : facets_(std::move(facets)), drag_coefficient_(drag_coefficient), density_(std::move(density)) {
  if (facets_.empty() || !density_)
    throw std::invalid_argument("an aerodynamic torque needs a surface and an atmosphere");
}

Vector3 AerodynamicTorque::torque_body(const ForceInput& orbit, const AttitudeState& attitude) {
  const Vector3 velocity_body = attitude.q_body_eci * velocity_through_air_eci(orbit);
  const Vector3 flow = velocity_body.normalized();  // the body's way through the air
  Vector3 area_times_arm = Vector3::Zero();
  for (const Facet& facet : facets_) {
    const double cosine = facet.normal.dot(flow);
    if (cosine > 0.0) area_times_arm += facet.area_m2 * cosine * facet.centre_m;
  }
  const double pressure = 0.5 * density_(orbit) * drag_coefficient_ * velocity_body.squaredNorm();
  return area_times_arm.cross(-pressure * flow);
}

}  // namespace vbar::truth
