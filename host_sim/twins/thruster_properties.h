#pragma once
// Properties of a thruster whose burns have a duration, as a mission states them.

namespace vbar::twins {

struct ThrusterProperties {
  double thrust_n = 0.0;
  double specific_impulse_s = 0.0;
  double propellant_kg = 0.0;       ///< at the start, part of the spacecraft's mass
  double minimum_impulse_ns = 0.0;  ///< impulse bit: shorter pulses are not possible, N s
  double maximum_on_time_s = 300.0;
  double rise_s = 0.0;  ///< from the valve's opening to full thrust
  double fall_s = 0.0;  ///< from the valve's closing to no thrust

  [[nodiscard]] double exhaust_velocity_mps() const { return specific_impulse_s * kStandardGravity; }
  static constexpr double kStandardGravity = 9.80665;  ///< m/s^2
};

}  // namespace vbar::twins
