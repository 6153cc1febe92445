#pragma once
// Torque of the gravity gradient over the body: T = 3 gm / r^3 (u x J u), u the unit vector from the Earth's centre
// (Hughes 2004, eq. 8.1.15; Wertz 1978, eq. 17-31). The Earth is a point mass: its oblateness would add a thousandth of
// the torque.

#include "host_sim/truth/attitude/torque.h"

namespace vbar::truth {

class GravityGradientTorque final : public Torque {
 public:
  /// Makes the torque from `gm` of the Earth in m^3/s^2; `inertia_kgm2` about the centre of mass, in body axes.
  GravityGradientTorque(double gm, const fsw::Matrix3& inertia_kgm2) : gm_(gm), inertia_(inertia_kgm2) {}

  [[nodiscard]] std::string_view name() const override { return "gravity_gradient"; }
  [[nodiscard]] fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) override;

 private:
  double gm_;
  fsw::Matrix3 inertia_;
};

}  // namespace vbar::truth
