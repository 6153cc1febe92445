#pragma once
// Atmospheric drag on a sphere (cannonball) in the air of NRLMSISE-00, which rotates with the Earth:
//   a = -1/2 (C_D A / m) rho |v_air| v_air,   v_air = v - omega x r   (Montenbruck & Gill 2000, eq. 3.97).
//
// - Density is that with anomalous oxygen, at geodetic latitude, longitude and altitude (WGS 84).
// - Local solar time is the model's own: universal time plus longitude, without the equation of time, as it
// was fitted.
// - The air rotates about ITRF's pole with the rate of the Earth rotation angle: against the true axis (polar motion,
// length
//   of day) an error of the air's velocity below 3 mm/s in low orbit, 1e-6 of the drag.
// - Winds are neglected.
//
// Solar indices are constant from one change to the next (0h UTC; every three hours with three-hourly indices), and so
// is the day of the year: there the force jumps, and reports it (force.h). There is no upper limit: above the 1000 km
// to which the model was fitted, its formulas are extrapolated. Below the ground: std::domain_error.

#include <memory>

#include "fsw/core/gps_time.h"
#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "host_sim/truth/earth/space_weather.h"
#include "host_sim/truth/forces/force.h"
#include "host_sim/truth/forces/force_model.h"

namespace vbar::truth {

class DragForce final : public Force {
 public:
  /// Makes the force. `tables` and `space_weather` are shared between spacecraft and must not be null; `epoch` is what
  /// ForceInput's seconds count from. Throws std::invalid_argument unless mass, drag area and drag coefficient are
  /// above zero and finite; std::out_of_range if the epoch is outside the space weather data.
  DragForce(const SurfaceProperties& spacecraft, std::shared_ptr<const Nrlmsise00Tables> tables,
            std::shared_ptr<const SpaceWeather> space_weather, GeomagneticIndex geomagnetic_index, fsw::GpsTime epoch);

  std::string_view name() const override { return "drag"; }

  /// Throws std::domain_error below the ground (and std::invalid_argument for a state that is not finite).
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

  double next_jump_after(double seconds) const override;

  /// Throws std::out_of_range outside the space weather data.
  void enter_interval(double seconds) override;

  /// Returns the air at a state, with the indices of the interval entered last.
  AtmosphereState atmosphere_at(const ForceInput& input);

 private:
  fsw::GpsTime instant(double seconds) const;

  double area_to_mass_;  // C_D A / m, m^2/kg
  Nrlmsise00 atmosphere_;
  std::shared_ptr<const SpaceWeather> space_weather_;
  GeomagneticIndex geomagnetic_index_;
  fsw::GpsTime epoch_;
  // Indices and day of the interval entered last.
  SolarIndices indices_;
  int day_of_year_ = 1;
  double midnight_s_ = 0.0;  // after the epoch
};

}  // namespace vbar::truth
