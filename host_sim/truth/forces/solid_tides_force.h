#pragma once
// The gravity of the tides of the solid Earth, and of the pole tides, as a force.

#include <memory>

#include "fsw/core/gps_time.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/low_degree_field.h"
#include "host_sim/truth/forces/solid_tides.h"

namespace vbar::truth {

/// Force of the tides: one object per spacecraft, as it caches the sums of step 2.
class SolidTidesForce final : public Force {
 public:
  /// Makes the force from `gm` (m^3/s^2), `radius` (m) and `tide_system` of the gravity model that it goes with;
  /// `orientation` of the days to come must not be null.
  SolidTidesForce(double gm, double radius, TideSystem tide_system, fsw::GpsTime epoch,
                  std::shared_ptr<const EarthOrientationSeries> orientation);

  std::string_view name() const override { return "solid_tides"; }
  bool needs_sun_and_moon() const override { return true; }

  /// Throws std::out_of_range outside the Earth orientation data.
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

  /// Returns the change of the gravity model's coefficients that makes the acceleration.
  LowDegreeCoefficients coefficients(const ForceInput& input);

 private:
  double gm_;
  double radius_;
  TideSystem tide_system_;
  fsw::GpsTime epoch_;
  std::shared_ptr<const EarthOrientationSeries> orientation_;
  FrequencyDependentTides frequency_dependent_;
};

}  // namespace vbar::truth
