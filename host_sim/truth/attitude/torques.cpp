#include "host_sim/truth/attitude/torques.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/radiation_pressure.h"

namespace vbar::truth {

using fsw::Vector3;

Facet facet_of_polygon(const std::vector<Vector3>& corners_m, double specular, double diffuse) {
  if (corners_m.size() < 3) throw std::invalid_argument("a facet needs three corners or more");
  if (!(specular >= 0.0 && diffuse >= 0.0 && specular + diffuse <= 1.0)) {
    throw std::invalid_argument("a facet's reflectivities must not be negative nor add to more than 1");
  }
  // A fan of triangles about the first corner.
  Vector3 doubled_area = Vector3::Zero();
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    doubled_area += (corners_m[k - 1] - corners_m[0]).cross(corners_m[k] - corners_m[0]);
  }
  Facet facet{.area_m2 = 0.5 * doubled_area.norm(), .specular = specular, .diffuse = diffuse};
  if (!(facet.area_m2 > 0.0)) throw std::invalid_argument("a facet has no area");
  facet.normal = doubled_area.normalized();
  for (std::size_t k = 2; k < corners_m.size(); ++k) {
    const Vector3 a = corners_m[k - 1] - corners_m[0], b = corners_m[k] - corners_m[0];
    if (!(std::abs(facet.normal.dot(b)) <= 1e-6 * b.norm())) {
      throw std::invalid_argument("a facet's corners do not lie in one plane");
    }
    const double share = 0.5 * facet.normal.dot(a.cross(b)) / facet.area_m2;
    facet.centre_m += share * (corners_m[0] + (a + b) / 3.0);
  }
  return facet;
}

fsw::Vector3 GravityGradientTorque::torque_body(const ForceInput& orbit, const AttitudeState& attitude) {
  const double r = orbit.position_eci.norm();
  const fsw::Vector3 u = attitude.q_body_eci * (orbit.position_eci / r);
  return 3.0 * gm_ / (r * r * r) * u.cross(inertia_ * u);
}

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
