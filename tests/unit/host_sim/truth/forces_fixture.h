#pragma once
// Dynamics with the forces that a test of the truth wants.

#include <memory>
#include <utility>
#include <vector>

#include "host_sim/truth/spacecraft_dynamics.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth::test {

inline std::unique_ptr<SpacecraftDynamics> dynamics_with(std::vector<std::unique_ptr<Force>> forces) {
  static const auto orientation = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(kDataDirectory / "earth/eop_2009_2013.csv"));
  return std::make_unique<SpacecraftDynamics>("test", kGm, kEarthRadius, EarthRotation(orientation, mission_epoch()),
                                              std::move(forces));
}

/// J2 about the inertial z axis.
class InertialJ2 final : public Force {
 public:
  std::string_view name() const override { return "inertial J2"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override {
    constexpr double kJ2 = 1.0826358191967e-3;
    const fsw::Vector3& r = input.position_eci;
    const double d = r.norm(), z2 = 5.0 * r.z() * r.z() / (d * d);
    const double scale = -1.5 * kJ2 * kGm * kEarthRadius * kEarthRadius / std::pow(d, 5);
    return scale * fsw::Vector3(r.x() * (1.0 - z2), r.y() * (1.0 - z2), r.z() * (3.0 - z2));
  }
};

}  // namespace vbar::truth::test
