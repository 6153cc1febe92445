#include "host_sim/truth/spacecraft_propagator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/orbital_motion.h"

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

/// Runs `work` and prefixes the messages of its exceptions with the spacecraft's name.
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

/// Elements of a state, and the date in the message if there are none.
fsw::orbit::QnsElements dated_elements(const SpacecraftDynamics& dynamics, const fsw::orbit::CartesianState& state,
                                       double seconds) {
  try {
    return elements_from_cartesian(state, dynamics.gm());
  } catch (const std::domain_error& error) {
    throw std::domain_error(fmt::format("{}, at {}", error.what(), dynamics.date(seconds)));
  }
}

/// Number of equal parts in which a step of `size` (s) is sampled: two, or enough that the parts are no longer than a
/// twelfth of the period of a circular orbit at the perigee, which bounds the angular rate about the Earth up to a
/// factor below 1.5 by the eccentricity.
int looks_along(double size, const fsw::Vector6& elements, double gm) {
  constexpr double kPartsOfPeriod = 12.0;
  constexpr int kMaxParts = 10000;  // a step of weeks, in the loosest of orbits: bounds the work
  const double perigee = elements[0] * (1.0 - std::hypot(elements[1], elements[2]));
  const double longest = kTwoPi / kPartsOfPeriod * std::sqrt(perigee / gm) * perigee;
  return std::clamp(static_cast<int>(std::ceil(std::min(size / longest, 1.0 * kMaxParts))), 2, kMaxParts);
}

}  // namespace

SpacecraftPropagator::SpacecraftPropagator(std::unique_ptr<SpacecraftDynamics> dynamics, double tolerance,
                                           double seconds, const fsw::orbit::CartesianState& osculating)
    : dynamics_(std::move(dynamics)),
      integrator_(Rates{dynamics_.get()}, element_tolerance<Integrator::Tolerance>(tolerance)),
      current_(seconds) {
  naming(name(), [&] {
    const fsw::orbit::QnsElements elements = dated_elements(*dynamics_, osculating, seconds);
    dynamics_->enter_regime_of(seconds, osculating);
    integrator_.start(seconds, vector_from_elements(elements));
  });
}

void SpacecraftPropagator::advance_to(double seconds) {
  if (!(seconds >= current_)) throw std::invalid_argument("the truth does not go back in time");
  naming(name(), [&] {
    while (integrator_.time() < seconds) {
      // An attitude under torques follows the orbit's steps one by one.
      if (attitude_) attitude_->advance_to(integrator_.time(), integrator_.time());
      step();
    }
    if (attitude_) attitude_->advance_to(seconds, integrator_.time());
  });
  current_ = seconds;
}

void SpacecraftPropagator::step() {
  const double jump = dynamics_->next_jump_after(integrator_.time());
  regime_of_last_step_ = dynamics_->regime();
  integrator_.step(std::min(jump, integrator_.time() + regime_of_last_step_.longest_step));
  const std::optional<Crossing> crossing = first_crossing_in_last_step();
  if (crossing) integrator_.cut_last_step(crossing->seconds);
  kept_.push_back({integrator_.time(), integrator_.last_step()});
  if (kept_.size() > kKeptSteps) kept_.pop_front();

  if (crossing) {
    dynamics_->cross_edge(crossing->edge, integrator_.time(), cartesian(integrator_.state()));
    ++edges_crossed_;
  }
  const bool jumped = integrator_.time() == jump;
  if (jumped) dynamics_->enter_interval(jump);
  if (crossing || jumped) integrator_.restart(integrator_.state());
  // The mean argument of latitude is kept within one revolution, so that its rounding stays that of an angle and not of
  // a number of revolutions.
  if (integrator_.state()[5] > M_PI) {
    fsw::Vector6 turn = fsw::Vector6::Zero();
    turn[5] = -kTwoPi;
    integrator_.translate(turn);
  }
}

double SpacecraftPropagator::edge_in_last_step(int edge, double seconds) const {
  return dynamics_->edge(edge, seconds, cartesian(integrator_.last_step()(seconds)));
}

std::optional<SpacecraftPropagator::Crossing> SpacecraftPropagator::first_crossing_in_last_step() const {
  if (dynamics_->edge_count() == 0) return std::nullopt;
  const DenseStep<6>& step = integrator_.last_step();
  const int samples = looks_along(step.size, step.c[0], dynamics_->gm());
  std::optional<Crossing> first;
  double end = integrator_.time();
  for (int edge = 0; edge < dynamics_->edge_count(); ++edge) {
    const double side = dynamics_->regime().sides[static_cast<std::size_t>(edge)] ? 1.0 : -1.0;
    const auto on_this_side = [&](double seconds) { return side * edge_in_last_step(edge, seconds); };
    const std::optional<double> exit = first_exit(on_this_side, step.start, end, samples, kEdgeResolution);
    if (exit) {
      first = Crossing{*exit, edge};
      end = *exit;
    }
  }
  return first;
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
  return cartesian(elements);
}

fsw::orbit::CartesianState SpacecraftPropagator::cartesian(const fsw::Vector6& elements) const {
  return orbit_geometry(elements_from_vector(elements), dynamics_->gm()).state;
}

OrbitalMotion SpacecraftPropagator::motion_at(double seconds) const {
  const fsw::orbit::CartesianState state = state_at(seconds);
  const double r = state.position_eci.norm();
  const fsw::Vector3 central = -dynamics_->gm() / (r * r * r) * state.position_eci;
  return {state.position_eci, state.velocity_eci, central + dynamics_->perturbation_eci(seconds, state)};
}

ForceInput SpacecraftPropagator::surroundings_at(double seconds) const {
  const double known = std::min(seconds, integrator_.time());
  return dynamics_->input_at(known, state_at(known));
}

AttitudeState SpacecraftPropagator::attitude_at(double seconds) const {
  if (!attitude_) throw std::logic_error(fmt::format("spacecraft \"{}\" has no attitude", name()));
  AttitudeState attitude;
  naming(name(), [&] { attitude = attitude_->state_at(seconds); });
  return attitude;
}

void SpacecraftPropagator::apply_impulse_rtn(const fsw::Vector3& dv_rtn) {
  if (!dv_rtn.allFinite())
    throw std::invalid_argument(fmt::format("spacecraft \"{}\": an impulse is not finite", name()));
  naming(name(), [&] {
    if (current_ < integrator_.time()) retake_last_step_to(current_);
    const OrbitGeometry before = orbit_geometry(elements_from_vector(integrator_.state()), dynamics_->gm());
    fsw::orbit::CartesianState after = before.state;
    after.velocity_eci += before.R_rtn_eci.transpose() * dv_rtn;
    const fsw::orbit::QnsElements elements = dated_elements(*dynamics_, after, current_);
    dynamics_->enter_regime_of(current_, after);
    integrator_.restart(vector_from_elements(elements));
    if (attitude_) attitude_->orbit_changed(current_);
  });
}

void SpacecraftPropagator::begin_burn(const ThrustArc& arc) {
  if (arc.begin_s != current_)
    throw std::invalid_argument(fmt::format("spacecraft \"{}\": a burn begins at another time than now", name()));
  naming(name(), [&] {
    if (current_ < integrator_.time()) retake_last_step_to(current_);
    dynamics_->add_burn(arc);
    dynamics_->enter_regime_of(current_, cartesian(integrator_.state()));
    integrator_.restart(integrator_.state());
    if (attitude_) attitude_->orbit_changed(current_);
  });
}

void SpacecraftPropagator::retake_last_step_to(double seconds) {
  // The step may have ended at an edge or a jump, and the forces been set to what follows.
  dynamics_->set_regime(regime_of_last_step_);
  integrator_.cut_last_step(seconds);
  kept_.back() = {seconds, integrator_.last_step()};
}

}  // namespace vbar::truth
