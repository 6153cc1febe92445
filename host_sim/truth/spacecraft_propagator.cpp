#include "host_sim/truth/spacecraft_propagator.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/gve.h"
#include "host_sim/truth/orbit_geometry.h"

namespace vbar::truth {
namespace {

template <class Tolerance>
Tolerance element_tolerance(double tolerance) {
  Tolerance of_elements;
  of_elements.relative << tolerance, 0.0, 0.0, 0.0, 0.0, 0.0;
  of_elements.absolute << 0.0, tolerance, tolerance, tolerance, tolerance, tolerance;
  return of_elements;
}

constexpr double kTwoPi = 2.0 * M_PI;

/// Runs `work` and puts the spacecraft's name before the message of what it throws.
template <class Work>
void naming(const std::string& name, const Work& work) {
  try {
    work();
  } catch (const std::domain_error& error) {
    throw std::domain_error(fmt::format("spacecraft \"{}\": {}", name, error.what()));
  } catch (const std::out_of_range& error) {
    throw std::out_of_range(fmt::format("spacecraft \"{}\": {}", name, error.what()));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("spacecraft \"{}\": {}", name, error.what()));
  }
}

}  // namespace

SpacecraftPropagator::SpacecraftPropagator(std::unique_ptr<SpacecraftDynamics> dynamics, double tolerance,
                                           double seconds, const fsw::orbit::CartesianState& osculating)
    : dynamics_(std::move(dynamics)),
      integrator_(Rates{dynamics_.get()}, element_tolerance<Integrator::Tolerance>(tolerance)),
      current_(seconds) {
  naming(name(), [&] {
    integrator_.start(seconds, vector_from_elements(elements_from_cartesian(osculating, dynamics_->gm())));
  });
}

void SpacecraftPropagator::advance_to(double seconds) {
  if (!(seconds >= current_)) throw std::invalid_argument("the truth does not go back in time");
  naming(name(), [&] {
    while (integrator_.time() < seconds) step();
  });
  current_ = seconds;
}

void SpacecraftPropagator::step() {
  integrator_.step();
  kept_.push_back({integrator_.time(), integrator_.last_step()});
  if (kept_.size() > kKeptSteps) kept_.pop_front();
  // The mean argument of latitude is kept within a turn, so that its rounding stays that of an angle and not of a count
  // of turns.
  if (integrator_.state()[5] > M_PI) {
    fsw::Vector6 turn = fsw::Vector6::Zero();
    turn[5] = -kTwoPi;
    integrator_.translate(turn);
  }
}

fsw::orbit::CartesianState SpacecraftPropagator::state_at(double seconds) const {
  fsw::Vector6 elements = integrator_.state();
  if (seconds != integrator_.time()) {
    auto kept = kept_.rbegin();
    // A time shared by two steps belongs to the later one, which begins after any impulse.
    while (kept != kept_.rend() && seconds < kept->solution.start) ++kept;
    if (kept == kept_.rend() || !(seconds <= kept->end)) {
      throw std::out_of_range(fmt::format("spacecraft \"{}\": no state {} s after the epoch; kept are {} s to {} s",
                                          name(), seconds, kept_.empty() ? current_ : kept_.front().solution.start,
                                          integrator_.time()));
    }
    elements = kept->solution(seconds);
  }
  return orbit_geometry(elements_from_vector(elements), dynamics_->gm()).state;
}

void SpacecraftPropagator::apply_impulse_rtn(const fsw::Vector3& dv_rtn) {
  if (!dv_rtn.allFinite())
    throw std::invalid_argument(fmt::format("spacecraft \"{}\": an impulse is not a number", name()));
  naming(name(), [&] {
    if (current_ < integrator_.time()) {
      integrator_.cut_last_step(current_);
      kept_.back() = {current_, integrator_.last_step()};
    }
    const OrbitGeometry before = orbit_geometry(elements_from_vector(integrator_.state()), dynamics_->gm());
    fsw::orbit::CartesianState after = before.state;
    after.velocity_eci += before.R_rtn_eci.transpose() * dv_rtn;
    integrator_.restart(vector_from_elements(elements_from_cartesian(after, dynamics_->gm())));
  });
}

}  // namespace vbar::truth
