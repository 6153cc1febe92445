#pragma once
// Torque of the air on a body's facets. Each facet that meets the flow takes from it the momentum of a Newtonian
// (hyperthermal) stream with one drag coefficient: dF = -1/2 rho C_D v^2 A cos(angle) along the flow (Wertz 1978, eq.
// 17-57). So a body's force is that of a cannonball with its projected area; lift, which needs the surface's
// accommodation, and the damping by the body's own rotation (cm/s against km/s) are left out. Facets do not shade each
// other (a convex body).

#include <functional>
#include <vector>

#include "host_sim/truth/attitude/body.h"
#include "host_sim/truth/attitude/torque.h"

namespace vbar::truth {

class AerodynamicTorque final : public Torque {
 public:
  /// Density of the air at a spacecraft, kg/m^3.
  using Density = std::function<double(const ForceInput& orbit)>;

  /// Throws std::invalid_argument without facets or density.
  AerodynamicTorque(std::vector<Facet> facets, double drag_coefficient, Density density);

  [[nodiscard]] std::string_view name() const override { return "aerodynamic"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;

 private:
  std::vector<Facet> facets_;
  double drag_coefficient_;
  Density density_;
};

/// Velocity with respect to an atmosphere that turns with the Earth, m/s, in ECI.
[[nodiscard]] fsw::Vector3 velocity_through_air_eci(const ForceInput& orbit);

}  // namespace vbar::truth
