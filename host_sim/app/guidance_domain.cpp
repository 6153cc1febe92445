#include "host_sim/app/guidance_domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <vbar/fields.h>

#include "fsw/control/solver_list.h"
#include "fsw/gnc/inbox.h"
#include "fsw/orbit/mean_osculating.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {
namespace {

/// A solver, and the largest mean eccentricity up to which the whole rendezvous with ideal navigation stays within
/// twice the control error and cost of the paper's orbit (docs/data_formats.md, "Orbits").
struct Domain {
  int solver = waypoint::kSolverNone;
  std::string_view name;         ///< in missions
  std::string_view description;  ///< words for the algorithm
  double max_eccentricity = 0.0;
};

constexpr std::array<Domain, fsw::control::kSolvers> kDomains = [] {
  std::array<Domain, fsw::control::kSolvers> domains{};
  fsw::control::any_solver([&]<class Entry>(std::size_t place) {
    domains[place] = {static_cast<int>(Entry::kId), Entry::kName, Entry::kDescription, Entry::kMaxEccentricity};
    return false;
  });
  return domains;
}();

/// The words of missions and telemetry are those of the code, for every solver.
static_assert(std::ranges::all_of(codes::waypoint_kSolver, [](const Code& code) {
  return code.value == waypoint::kSolverNone || std::ranges::any_of(kDomains, [&](const Domain& domain) {
           return domain.solver == code.value && domain.name == code.word;
         });
}));

const Domain& domain_of(mission::Solver solver) {
  return kDomains[fsw::control::place_of(static_cast<fsw::control::Solver>(solver))];
}

/// Relative quasi-nonsingular elements are singular in the equator: the nodes of two spacecraft lie 1/sin i of their
/// relative inclination apart, and what is linear in this angle, or mean to first order, errs by as much. Measured with
/// the rendezvous of missions/user_orbit_400km.toml, for all solvers alike and for eccentricities from 0 to 0.007, the
/// largest control error is 0.8 to 1.8 m at 5 deg and grows as 1/sin i below (docs/data_formats.md).
constexpr double kMinInclination_deg = 5.0;

std::string alternatives(double eccentricity) {
  std::string names;
  for (const Domain& domain : kDomains)
    if (eccentricity <= domain.max_eccentricity) names += fmt::format("{}{}", names.empty() ? "" : " or ", domain.name);
  return names.empty() ? "no planner of this flight software; flight_computer.library may name another one"
                       : fmt::format("solver = {}", names);
}

void check_inclination(double inclination_rad, const std::string& spacecraft) {
  const double inclination_deg = inclination_rad * 180.0 / std::numbers::pi;
  const double from_equator_deg = std::min(inclination_deg, 180.0 - inclination_deg);
  if (from_equator_deg >= kMinInclination_deg) return;
  throw std::runtime_error(fmt::format(
      "spacecraft \"{}\": its mean inclination is {:.4f} deg; accepted: {} to {} deg, where the relative orbital "
      "elements of this flight software are regular (its control error grows as 1 / sin i); flight_computer.library "
      "may name "
      "another one",
      spacecraft, inclination_deg, kMinInclination_deg, 180.0 - kMinInclination_deg));
}

/// The packets of a run that lasts longer are all refused.
void check_packet_times(const mission::Mission& mission) {
  if (mission.end_time() <= fsw::gnc::kLatestTime) return;
  throw std::runtime_error(
      fmt::format("mission.epoch_utc: the run ends at {}; accepted: up to {}, the last time that "
                  "packets of the flight software carry",
                  truth::format_utc(mission.end_time(), 0), truth::format_utc(fsw::gnc::kLatestTime, 0)));
}

}  // namespace

void check_guidance_domain(const mission::Mission& mission, const mission::Spacecraft& servicer,
                           const fsw::orbit::CartesianState& servicer_state) {
  if (!servicer.flight_computer) return;
  const bool is_of_vbar = servicer.flight_computer->library.empty();
  if (is_of_vbar) check_packet_times(mission);
  const auto osculating = fsw::orbit::qns_from_cartesian(servicer_state);
  const auto mean = osculating.ok() ? fsw::orbit::mean_from_osculating(osculating.value()) : osculating;
  if (!mean.ok())
    throw std::runtime_error(fmt::format(
        "spacecraft \"{}\": its orbit has no mean elements (first-order Brouwer theory: eccentricity below 0.9, "
        "inclination not 0 or 180 deg), which the record of a flight needs",
        servicer.name));
  if (!is_of_vbar || mission.guidance.mode != mission::Mode::kApproach) return;
  const double eccentricity = std::hypot(mean.value().ex, mean.value().ey);
  check_inclination(mean.value().i, servicer.name);
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
