#pragma once
// The interface of every torque on a rigid body: one call, one small file each, as the forces on its orbit
// (forces/force.h). A torque object belongs to one spacecraft.
//
// A torque may jump, as a force may: at an edge (a zero of a function of time and orbit: sunlight ends) or at a date
// known beforehand (the day's solar flux). The integration ends a step exactly there; in between the torque acts as on
// the side, or in the interval, that was set.

#include <limits>
#include <string_view>

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_state.h"
#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

class Torque {
 public:
  Torque() = default;
  Torque(const Torque&) = delete;
  Torque& operator=(const Torque&) = delete;
  virtual ~Torque() = default;

  /// Returns the name as in the mission file and in tables: "gravity_gradient", "aerodynamic", "radiation".
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Returns the torque about the centre of mass, N m, in body axes. `orbit`: where the spacecraft is at that instant.
  [[nodiscard]] virtual fsw::Vector3 torque_body(const ForceInput& orbit, const AttitudeState& attitude) = 0;

  /// Returns the number of its edges, and the function of time and orbit whose zero edge `index` is.
  [[nodiscard]] virtual int edge_count() const { return 0; }
  [[nodiscard]] virtual double edge(int /*index*/, const ForceInput& /*orbit*/) const { return 1.0; }

  /// Sets the side: from here on (until the next call) the motion is on this side of the edge: edge() positive, or not.
  virtual void set_side(int /*index*/, bool /*positive*/) {}

  /// Returns the first date (seconds after the epoch) after `seconds` at which it jumps by itself.
  [[nodiscard]] virtual double next_jump_after(double /*seconds*/) const {
    return std::numeric_limits<double>::infinity();
  }

  /// Enters the interval in which the motion (re)starts at `seconds`: until the next jump the torque is that of the
  /// interval that begins here.
  virtual void enter_interval(double /*seconds*/) {}
};

}  // namespace vbar::truth
