#include "host_sim/app/guidance_domain.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fsw/orbit/mean_osculating.h"

namespace vbar::app {
namespace {

struct Domain {
  mission::Solver solver;
  std::string_view name;         ///< in missions
  std::string_view description;  ///< of the algorithm
  double max_eccentricity;
};

/// Limits: eccentricities up to which the whole rendezvous with ideal navigation stays within twice the control error
/// and cost of the paper's orbit (docs/data_formats.md, "Orbits"). Beyond them terms of order e that the closed form
/// iterates away, and the fixed time grid of the primer-vector solver, which is coarse about perigee, dominate.
constexpr std::array<Domain, 3> kDomains{{
    {mission::Solver::kClosedForm, "closed_form",
     "the closed-form solver for near-circular orbits (Chernick and D'Amico 2018)", 0.06},
    {mission::Solver::kKoenigDamico, "koenig_damico",
     "the primer-vector solver on a uniform grid of times (Koenig and D'Amico)", 0.11},
    {mission::Solver::kLeastSquares, "least_squares", "the least-squares solver on a uniform grid of times", 0.06},
}};

const Domain& domain_of(mission::Solver solver) {
  for (const Domain& domain : kDomains)
    if (domain.solver == solver) return domain;
  return kDomains.front();
}

std::string alternatives(double eccentricity) {
  std::string names;
  for (const Domain& domain : kDomains)
    if (eccentricity <= domain.max_eccentricity) names += fmt::format("{}{}", names.empty() ? "" : " or ", domain.name);
  return names.empty() ? "no planner of this flight software; flight_computer.library may name another one"
                       : fmt::format("solver = {}", names);
}

}  // namespace

void check_guidance_domain(const mission::Mission& mission, const mission::Spacecraft& servicer,
                           const fsw::orbit::CartesianState& servicer_state) {
  if (mission.guidance.mode != mission::Mode::kApproach || !servicer.flight_computer ||
      !servicer.flight_computer->library.empty())
    return;
  const auto osculating = fsw::orbit::qns_from_cartesian(servicer_state);
  const auto mean = osculating.ok() ? fsw::orbit::mean_from_osculating(osculating.value()) : osculating;
  if (!mean.ok())
    throw std::runtime_error(fmt::format(
        "spacecraft \"{}\": its orbit has no mean elements (first-order Brouwer theory: eccentricity below 0.9, "
        "inclination not 0 or 180 deg), which guidance needs",
        servicer.name));
  const double eccentricity = std::hypot(mean.value().ex, mean.value().ey);
  for (const mission::Waypoint& waypoint : mission.waypoints) {
    if (waypoint.time <= mission.start_time()) continue;
    const Domain& domain = domain_of(waypoint.solver);
    if (eccentricity <= domain.max_eccentricity) continue;
    throw std::runtime_error(fmt::format(
        "waypoint {}: solver = {} is {}, for mean eccentricities up to {}; the orbit of spacecraft \"{}\" has {:.4f}; "
        "accepted: {}",
        waypoint.index, domain.name, domain.description, domain.max_eccentricity, servicer.name, eccentricity,
        alternatives(eccentricity)));
  }
}

}  // namespace vbar::app
