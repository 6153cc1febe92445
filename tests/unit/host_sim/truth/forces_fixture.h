#pragma once
// Dynamics with the forces that a test of the truth wants.

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "host_sim/truth/spacecraft_propagator.h"
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

/// 0.02 m^2/kg: the servicer's.
inline SurfaceProperties surface() {
  SurfaceProperties properties;
  properties.mass_kg = 154.0;
  properties.radiation_area_m2 = 2.5;
  properties.radiation_coefficient = 1.32;
  return properties;
}

template <class... Forces>
std::vector<std::unique_ptr<Force>> list(std::unique_ptr<Forces>... forces) {
  std::vector<std::unique_ptr<Force>> all;
  (all.push_back(std::move(forces)), ...);
  return all;
}

inline std::unique_ptr<RadiationPressureForce> sunlight(Shadow shadow) {
  return std::make_unique<RadiationPressureForce>(surface(), shadow);
}

/// The servicer after `seconds`, from the mission's start.
inline fsw::orbit::CartesianState fly(std::vector<std::unique_ptr<Force>> forces, double tolerance, double seconds,
                                      IntegrationStatistics* statistics = nullptr) {
  SpacecraftPropagator propagator(dynamics_with(std::move(forces)), tolerance, 0.0, servicer_state());
  propagator.advance_to(seconds);
  if (statistics != nullptr) *statistics = propagator.statistics();
  return propagator.state();
}

}  // namespace vbar::truth::test
