#pragma once
// The interface of every force on a spacecraft: one call, one small file each. A force object belongs to one spacecraft
// (it may hold the spacecraft's properties and caches of its own); large constant data are shared between them.
//
// A force may jump: sunlight ends at the shadow's edge, the day's solar flux at midnight. No integrator of order 5
// keeps its order across a jump, so a force states where its jumps are, and the propagator ends a step exactly there:
//   - at an edge, a zero of a function of time and state; in between, the force acts as on the side that was set;
//   - at a date, known beforehand.
// In between a force must be smooth.

#include <limits>
#include <string_view>

#include "fsw/core/types.h"

namespace vbar::truth {

/// The instant and state at which forces are evaluated, with the quantities that several of them need.
struct ForceInput {
  double seconds = 0.0;  ///< after the model's epoch
  fsw::Vector3 position_eci = fsw::Vector3::Zero();
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();
  fsw::Matrix3 R_itrf_gcrf = fsw::Matrix3::Identity();
  fsw::Vector3 position_itrf = fsw::Vector3::Zero();
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();   ///< geocentric, m; only if a force needs the Sun and the Moon
  fsw::Vector3 moon_eci = fsw::Vector3::Zero();  ///< the same of the Moon
};

class Force {
 public:
  virtual ~Force() = default;

  /// Returns the name as in the mission file and in tables: "drag", "radiation_pressure", ...
  virtual std::string_view name() const = 0;

  /// Returns the acceleration, m/s^2, in ECI, beside that of the Earth's point mass: a function of the input and of the
  /// sides and the interval set, not of earlier calls (a table of forces evaluates them at its own instants).
  virtual fsw::Vector3 acceleration_eci(const ForceInput& input) = 0;

  /// Returns whether the input must hold the Sun and the Moon.
  virtual bool needs_sun_and_moon() const { return false; }

  /// Returns the number of its edges, and the function whose zero edge `index` is.
  virtual int edge_count() const { return 0; }
  virtual double edge(int /*index*/, const ForceInput& /*input*/) const { return 1.0; }

  /// Sets the side: from here on (until the next call) the motion is on this side of the edge: edge() positive, or not.
  virtual void set_side(int /*index*/, bool /*positive*/) {}

  /// Returns the longest step, s, over which it is smooth enough from here on, on the sides that were set: queried at
  /// the start and whenever a side changes. Infinity: the integrator's own step control is enough.
  virtual double longest_step(const ForceInput& /*input*/) const { return std::numeric_limits<double>::infinity(); }

  /// Returns the first date (seconds after the epoch) after `seconds` at which it jumps by itself.
  virtual double next_jump_after(double /*seconds*/) const { return std::numeric_limits<double>::infinity(); }

  /// Enters the interval in which the motion (re)starts at `seconds`: until the next jump the force is that of the
  /// interval that begins here.
  virtual void enter_interval(double /*seconds*/) {}
};

}  // namespace vbar::truth
