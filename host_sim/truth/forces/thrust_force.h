#pragma once
// Finite thrust: burns with a rise and a fall, whose propellant leaves the spacecraft.

#include <deque>

#include "fsw/core/types.h"
#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

/// A burn: a force that rises from zero to its peak, holds and falls, each linear in time, in a direction that is fixed
/// in the spacecraft's own RTN.
struct ThrustArc {
  double begin_s = 0.0;  ///< after the model's epoch
  double rise_s = 0.0, hold_s = 0.0, fall_s = 0.0;
  double peak_n = 0.0;
  fsw::Vector3 direction_rtn = fsw::Vector3::UnitY();  ///< unit vector
  double mass_kg = 0.0;                                ///< at its begin
  double exhaust_velocity_mps = 0.0;                   ///< specific impulse times standard gravity

  [[nodiscard]] double duration_s() const { return rise_s + hold_s + fall_s; }
  [[nodiscard]] double end_s() const { return begin_s + rise_s + hold_s + fall_s; }
  [[nodiscard]] double force_n(double seconds) const;
  /// Returns the integral of the force from the begin on, N s.
  [[nodiscard]] double impulse_ns(double seconds) const;
  [[nodiscard]] double mass_at_kg(double seconds) const;
};

/// The force on a spacecraft whose burns have a duration. It jumps, or its slope does, at the corners of each burn.
class ThrustForce final : public Force {
 public:
  /// Adds a burn, which begins no earlier than the last one ended.
  void add(const ThrustArc& arc);

  std::string_view name() const override { return "thrust"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;
  double next_jump_after(double seconds) const override;
  void enter_interval(double seconds) override;

 private:
  std::deque<ThrustArc> arcs_;  ///< in order of time; the last few, as far back as states are asked for
  const ThrustArc* acting_ = nullptr;
};

}  // namespace vbar::truth
