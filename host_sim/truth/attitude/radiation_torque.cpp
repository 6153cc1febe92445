#include "host_sim/truth/attitude/radiation_torque.h"

#include <stdexcept>
#include <utility>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"

namespace vbar::truth {

using fsw::Vector3;

RadiationTorque::RadiationTorque(std::vector<Facet> facets, std::unique_ptr<Sunlight> sunlight)
    : facets_(std::move(facets)), sunlight_(std::move(sunlight)) {
  if (facets_.empty() || !sunlight_) throw std::invalid_argument("a radiation torque needs a surface and sunlight");
}

Vector3 RadiationTorque::torque_body(const ForceInput& orbit, const AttitudeState& attitude) {
  const double fraction = sunlight_->fraction(orbit);
  if (fraction == 0.0) return Vector3::Zero();
  const Vector3 to_sun_eci = orbit.sun_eci - orbit.position_eci;
  const double distance_au = to_sun_eci.norm() / kAstronomicalUnit;
  const Vector3 s = attitude.q_body_eci * to_sun_eci.normalized();
  Vector3 torque = Vector3::Zero();
  for (const Facet& facet : facets_) {
    const double cosine = facet.normal.dot(s);
    if (cosine <= 0.0) continue;
    const Vector3 push =
        (1.0 - facet.specular) * s + 2.0 * (facet.specular * cosine + facet.diffuse / 3.0) * facet.normal;
    torque -= facet.area_m2 * cosine * facet.centre_m.cross(push);
  }
  return fraction * kSolarPressure / (distance_au * distance_au) * torque;
}

}  // namespace vbar::truth
