#pragma once
// A circular orbit about a point mass, in closed form.

#include <cmath>

#include "host_sim/truth/forces/force.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth::test {

inline constexpr double kTwoPi = 2.0 * 3.14159265358979323846;

/// In the plane through the node on the x axis with the given inclination, rad; at the node at time 0.
struct CircularOrbit {
  double radius = 7078e3;
  double inclination = 1.7;

  double mean_motion() const { return std::sqrt(kGm / (radius * radius * radius)); }
  double period() const { return kTwoPi / mean_motion(); }

  fsw::Vector3 at_phase(double phase) const {
    return {std::cos(phase), std::sin(phase) * std::cos(inclination), std::sin(phase) * std::sin(inclination)};
  }
  fsw::Vector3 position(double t) const { return radius * at_phase(mean_motion() * t); }
  fsw::Vector3 velocity(double t) const { return radius * mean_motion() * at_phase(mean_motion() * t + 0.25 * kTwoPi); }
  fsw::Vector3 normal() const { return {0.0, -std::sin(inclination), std::cos(inclination)}; }

  ForceInput operator()(double t) const {
    ForceInput input;
    input.seconds = t;
    input.position_eci = position(t);
    input.velocity_eci = velocity(t);
    return input;
  }
};

}  // namespace vbar::truth::test
