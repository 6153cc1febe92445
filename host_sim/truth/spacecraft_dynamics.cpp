#include "host_sim/truth/spacecraft_dynamics.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/orbital_motion.h"

namespace vbar::truth {
namespace {

/// Adds the time since the last lap to a sum.
class Laps {
 public:
  void add_to(std::int64_t& sum_ns) {
    const auto now = std::chrono::steady_clock::now();
    sum_ns += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

SpacecraftDynamics::SpacecraftDynamics(std::string name, double gm, double earth_radius, EarthRotation earth_rotation,
                                       std::vector<std::unique_ptr<Force>> forces)
    : name_(std::move(name)),
      gm_(gm),
      earth_radius_(earth_radius),
      earth_rotation_(std::move(earth_rotation)),
      forces_(std::move(forces)),
      times_ns_(forces_.size() + 1) {
  for (const auto& force : forces_) {
    if (auto* const thrust = dynamic_cast<ThrustForce*>(force.get())) thrust_ = thrust;
    needs_sun_and_moon_ = needs_sun_and_moon_ || force->needs_sun_and_moon();
    for (int index = 0; index < force->edge_count(); ++index) edges_.push_back({force.get(), index});
  }
  regime_.sides.assign(edges_.size(), true);
  for (const EdgeOfForce& edge : edges_) edge.force->set_side(edge.index, true);
}

fsw::Vector6 SpacecraftDynamics::element_rates(double seconds, const fsw::Vector6& elements) {
  const fsw::orbit::QnsElements osculating = elements_from_vector(elements);
  OrbitGeometry geometry;
  try {
    geometry = orbit_geometry(osculating, gm_);
  } catch (const std::domain_error& error) {
    throw std::domain_error(fmt::format("{}, at {}", error.what(), date(seconds)));
  }
  const fsw::Vector3 perturbation = perturbation_eci(seconds, geometry.state);
  return gve_rates(osculating, geometry, geometry.R_rtn_eci * perturbation);
}

fsw::Vector3 SpacecraftDynamics::perturbation_eci(double seconds, const fsw::orbit::CartesianState& state) {
  check_altitude(seconds, state.position_eci);
  if (measures_time_) return timed_perturbation_eci(seconds, state);
  const ForceInput input = input_at(seconds, state);
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (const auto& force : forces_) sum += force->acceleration_eci(input);
  return sum;
}

fsw::Vector3 SpacecraftDynamics::timed_perturbation_eci(double seconds, const fsw::orbit::CartesianState& state) {
  Laps laps;
  const ForceInput input = input_at(seconds, state);
  laps.add_to(times_ns_[0]);
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    sum += forces_[i]->acceleration_eci(input);
    laps.add_to(times_ns_[i + 1]);
  }
  return sum;
}

std::vector<ForceAcceleration> SpacecraftDynamics::accelerations(double seconds,
                                                                 const fsw::orbit::CartesianState& state) {
  const ForceRegime told = regime_;
  enter_regime_of(seconds, state);
  const ForceInput input = input_at(seconds, state);
  std::vector<ForceAcceleration> shares;
  shares.reserve(forces_.size());
  for (const auto& force : forces_) shares.push_back({force->name(), force->acceleration_eci(input)});
  set_regime(told);
  return shares;
}

double SpacecraftDynamics::edge(int index, double seconds, const fsw::orbit::CartesianState& state) {
  const EdgeOfForce& edge = edges_.at(static_cast<std::size_t>(index));
  return edge.force->edge(edge.index, input_at(seconds, state));
}

void SpacecraftDynamics::set_regime(const ForceRegime& regime) {
  regime_ = regime;
  for (std::size_t i = 0; i < edges_.size(); ++i) edges_[i].force->set_side(edges_[i].index, regime_.sides.at(i));
  enter_interval(regime.seconds);
}

void SpacecraftDynamics::enter_regime_of(double seconds, const fsw::orbit::CartesianState& state) {
  const ForceInput input = input_at(seconds, state);
  ForceRegime regime;
  regime.seconds = seconds;
  for (const EdgeOfForce& edge : edges_) regime.sides.push_back(edge.force->edge(edge.index, input) > 0.0);
  set_regime(regime);
  regime_.longest_step = longest_step(input);
}

void SpacecraftDynamics::cross_edge(int index, double seconds, const fsw::orbit::CartesianState& state) {
  const auto i = static_cast<std::size_t>(index);
  regime_.sides.at(i) = !regime_.sides.at(i);
  edges_[i].force->set_side(edges_[i].index, regime_.sides[i]);
  regime_.longest_step = longest_step(input_at(seconds, state));
}

double SpacecraftDynamics::longest_step(const ForceInput& input) const {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& force : forces_) shortest = std::min(shortest, force->longest_step(input));
  return shortest;
}

void SpacecraftDynamics::enter_interval(double seconds) {
  regime_.seconds = seconds;
  for (const auto& force : forces_) force->enter_interval(seconds);
}

double SpacecraftDynamics::next_jump_after(double seconds) const {
  double first = std::numeric_limits<double>::infinity();
  for (const auto& force : forces_) first = std::min(first, force->next_jump_after(seconds));
  return first;
}

void SpacecraftDynamics::add_burn(const ThrustArc& arc) {
  if (thrust_ == nullptr) throw std::logic_error(fmt::format("spacecraft \"{}\": its burns are impulses", name_));
  thrust_->add(arc);
}

void SpacecraftDynamics::measure_time(bool on) {
  measures_time_ = on;
}

std::vector<ForceTime> SpacecraftDynamics::times() const {
  std::vector<ForceTime> times;
  for (std::size_t i = 0; i < times_ns_.size(); ++i) {
    times.push_back({i == 0 ? "frames" : forces_[i - 1]->name(), 1e-9 * static_cast<double>(times_ns_[i])});
  }
  return times;
}

std::string SpacecraftDynamics::date(double seconds) const {
  return format_utc(earth_rotation_.epoch() + fsw::nearest_duration(seconds));
}

ForceInput SpacecraftDynamics::input_at(double seconds, const fsw::orbit::CartesianState& state) {
  ForceInput input;
  input.seconds = seconds;
  input.position_eci = state.position_eci;
  input.velocity_eci = state.velocity_eci;
  input.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(seconds);
  input.position_itrf = input.R_itrf_gcrf * state.position_eci;
  if (needs_sun_and_moon_) {
    const SunMoon positions = sun_moon_.at(tt_of(earth_rotation_.epoch(), seconds));
    input.sun_eci = positions.sun_eci;
    input.moon_eci = positions.moon_eci;
  }
  return input;
}

fsw::Vector3 SpacecraftDynamics::sun_eci_at(double seconds) {
  return sun_moon_.at(tt_of(earth_rotation_.epoch(), seconds)).sun_eci;
}

void SpacecraftDynamics::check_altitude(double seconds, const fsw::Vector3& position_eci) const {
  const double altitude = position_eci.norm() - earth_radius_;
  // Written so that a NaN is rejected as well.
  if (!(altitude > kReentryAltitude)) {
    throw std::domain_error(fmt::format("re-enters: {:.1f} km above the Earth at {}", 1e-3 * altitude, date(seconds)));
  }
}

}  // namespace vbar::truth
