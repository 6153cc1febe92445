#pragma once
// The equations of motion of one spacecraft: Gauss's variational equations driven by a list of forces.

#include <memory>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

/// Not thread-safe: one object a spacecraft.
class SpacecraftDynamics {
 public:
  /// `name` for messages; `gm` (m^3/s^2) and `earth_radius` (m) of the central body; forces beside the point mass.
  SpacecraftDynamics(std::string name, double gm, double earth_radius, EarthRotation earth_rotation,
                     std::vector<std::unique_ptr<Force>> forces);

  /// Rates of the osculating elements [a, ex, ey, i, raan, u] `seconds` after the epoch.
  /// Throws std::domain_error if the spacecraft is below the Earth's radius or its orbit no ellipse.
  fsw::Vector6 element_rates(double seconds, const fsw::Vector6& elements);

  /// Sum of all forces, m/s^2 in ECI, beside the point mass: what a Cartesian integration would use.
  fsw::Vector3 perturbation_eci(double seconds, const fsw::orbit::CartesianState& state);

  const std::string& name() const { return name_; }
  double gm() const { return gm_; }

 private:
  std::string name_;
  double gm_;
  double earth_radius_;
  EarthRotation earth_rotation_;
  std::vector<std::unique_ptr<Force>> forces_;
};

}  // namespace vbar::truth
