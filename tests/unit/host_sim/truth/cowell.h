#pragma once
// An independent propagation of the same forces: Newton's equations in Cartesian coordinates (Cowell's method),
// integrated by Boost.Odeint's Fehlberg 7(8).

#include <array>

#include <boost/numeric/odeint.hpp>

#include "fsw/orbit/elements.h"
#include "host_sim/truth/spacecraft_dynamics.h"

namespace vbar::truth::test {

/// State `to` seconds after the epoch of one that is `from` seconds after it. `tolerance` is the relative local error.
inline fsw::orbit::CartesianState cowell(SpacecraftDynamics& dynamics, const fsw::orbit::CartesianState& state,
                                         double from, double to, double tolerance = 1e-14) {
  using State = std::array<double, 6>;
  using Stepper = boost::numeric::odeint::runge_kutta_fehlberg78<State>;
  const auto rates = [&](const State& y, State& rate, double t) {
    fsw::orbit::CartesianState now;
    now.position_eci << y[0], y[1], y[2];
    now.velocity_eci << y[3], y[4], y[5];
    const double r = now.position_eci.norm();
    const fsw::Vector3 acceleration =
        dynamics.perturbation_eci(t, now) - dynamics.gm() / (r * r * r) * now.position_eci;
    for (int i = 0; i < 3; ++i) {
      rate[static_cast<std::size_t>(i)] = now.velocity_eci[i];
      rate[static_cast<std::size_t>(i) + 3] = acceleration[i];
    }
  };
  State y;
  for (int i = 0; i < 3; ++i) {
    y[static_cast<std::size_t>(i)] = state.position_eci[i];
    y[static_cast<std::size_t>(i) + 3] = state.velocity_eci[i];
  }
  // Copied from a static object, whose scratch memory is zero: GCC rightly dislikes copying what was never written.
  static const Stepper stepper;
  boost::numeric::odeint::integrate_adaptive(boost::numeric::odeint::make_controlled(0.0, tolerance, stepper), rates, y,
                                             from, to, 10.0);
  fsw::orbit::CartesianState end;
  end.position_eci << y[0], y[1], y[2];
  end.velocity_eci << y[3], y[4], y[5];
  return end;
}

}  // namespace vbar::truth::test
