#include "host_sim/truth/attitude/aerodynamic_torque.h"

#include <stdexcept>
#include <utility>

namespace vbar::truth {

using fsw::Vector3;

namespace {

constexpr double kEarthRate_radps = 7.292115146706979e-5;  // rate of the Earth rotation angle (IERS 2010, eq. 5.15)

}  // namespace

Vector3 velocity_through_air_eci(const ForceInput& orbit) {
  const Vector3 pole_eci = orbit.R_itrf_gcrf.row(2).transpose();
  return orbit.velocity_eci - kEarthRate_radps * pole_eci.cross(orbit.position_eci);
}

AerodynamicTorque::AerodynamicTorque(std::vector<Facet> facets, double drag_coefficient, std::unique_ptr<Air> air)
    : facets_(std::move(facets)), drag_coefficient_(drag_coefficient), air_(std::move(air)) {
  if (facets_.empty() || !air_) throw std::invalid_argument("an aerodynamic torque needs a surface and an atmosphere");
}

Vector3 AerodynamicTorque::torque_body(const ForceInput& orbit, const AttitudeState& attitude) {
  const Vector3 velocity_body = attitude.q_body_eci * velocity_through_air_eci(orbit);
  const Vector3 flow = velocity_body.normalized();  // direction of motion through the air
  Vector3 area_times_arm = Vector3::Zero();
  for (const Facet& facet : facets_) {
    const double cosine = facet.normal.dot(flow);
    if (cosine > 0.0) area_times_arm += facet.area_m2 * cosine * facet.centre_m;
  }
  const double pressure = 0.5 * air_->density(orbit) * drag_coefficient_ * velocity_body.squaredNorm();
  return area_times_arm.cross(-pressure * flow);
}

}  // namespace vbar::truth
