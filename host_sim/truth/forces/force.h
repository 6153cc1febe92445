#pragma once
// What every force on a spacecraft looks like: one call, one small file each. A force object belongs to one spacecraft
// (it may hold the spacecraft's properties and caches of its own); what is large and constant is shared between them.
//
// A force may jump: sunlight ends at the shadow's edge, the day's solar flux at midnight. No integrator of order 5
// stays one across a jump, so a force says where its jumps are, and the propagator ends a step exactly there:
//   - at an edge, a zero of a function of time and state; in between, the force acts as on the side it was told;
//   - at a date, known beforehand.
// In between a force must be smooth.

#include <limits>
#include <string_view>

#include "fsw/core/types.h"

namespace vbar::truth {

/// The instant and state at which forces are asked for, with what several of them need.
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

  /// As in the mission file and in tables: "drag", "radiation_pressure", ...
  virtual std::string_view name() const = 0;

  /// Acceleration, m/s^2, in ECI, beside that of the Earth's point mass: a function of the input and of the sides and
  /// the interval told, not of earlier calls (a table of forces asks at instants of its own).
  virtual fsw::Vector3 acceleration_eci(const ForceInput& input) = 0;

  /// Whether the input must hold the Sun and the Moon.
  virtual bool needs_sun_and_moon() const { return false; }

  /// How many edges it has, and the function whose zero edge `index` is.
  virtual int edge_count() const { return 0; }
  virtual double edge(int /*index*/, const ForceInput& /*input*/) const { return 1.0; }

  /// From here on (until told otherwise) the motion is on this side of the edge: edge() positive, or not.
  virtual void set_side(int /*index*/, bool /*positive*/) {}

  /// The longest step, s, over which it is smooth enough from here on, on the sides it was told: asked for at the start
  /// and wherever a side changes. Infinity: the integrator's own step control is enough.
  virtual double longest_step(const ForceInput& /*input*/) const { return std::numeric_limits<double>::infinity(); }

  /// The first date (seconds after the epoch) after `seconds` at which it jumps by itself.
  virtual double next_jump_after(double /*seconds*/) const { return std::numeric_limits<double>::infinity(); }

  /// The motion (re)starts at `seconds`: until the next jump the force is that of the interval that begins here.
  virtual void enter_interval(double /*seconds*/) {}
};

}  // namespace vbar::truth
