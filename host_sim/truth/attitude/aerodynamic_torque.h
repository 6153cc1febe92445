#pragma once
// Torque of the air on a body's facets. Each facet that meets the flow takes from it the momentum of a Newtonian
// (hyperthermal) stream with one drag coefficient: dF = -1/2 rho C_D v^2 A cos(angle) along the flow (Wertz 1978, eq.
// 17-57). So a body's force is that of a cannonball with its projected area; lift, which needs the surface's
// accommodation, and the damping by the body's own rotation (cm/s against km/s) are neglected. Facets do not shade each
// other (a convex body).

#include <limits>
#include <memory>
#include <vector>

#include "host_sim/truth/attitude/body.h"
#include "host_sim/truth/attitude/torque.h"

namespace vbar::truth {

/// The air at a spacecraft. Its discontinuities have dates, as those of a torque have.
class Air {
 public:
  Air() = default;
  Air(const Air&) = delete;
  Air& operator=(const Air&) = delete;
  virtual ~Air() = default;

  /// Returns the density, kg/m^3, in the interval entered last.
  [[nodiscard]] virtual double density(const ForceInput& orbit) = 0;

  [[nodiscard]] virtual double next_jump_after(double /*seconds*/) const {
    return std::numeric_limits<double>::infinity();
  }
  virtual void enter_interval(double /*seconds*/) {}
};

class AerodynamicTorque final : public Torque {
 public:
  /// Throws std::invalid_argument without facets or air.
  AerodynamicTorque(std::vector<Facet> facets, double drag_coefficient, std::unique_ptr<Air> air);

  [[nodiscard]] std::string_view name() const override { return "aerodynamic"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;
  [[nodiscard]] double next_jump_after(double seconds) const override { return air_->next_jump_after(seconds); }
  void enter_interval(double seconds) override { air_->enter_interval(seconds); }

 private:
  std::vector<Facet> facets_;
  double drag_coefficient_;
  std::unique_ptr<Air> air_;
};

/// Returns the velocity with respect to an atmosphere that rotates with the Earth, m/s, in ECI.
[[nodiscard]] fsw::Vector3 velocity_through_air_eci(const ForceInput& orbit);

}  // namespace vbar::truth
