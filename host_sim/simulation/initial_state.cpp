#include "host_sim/simulation/initial_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <vbar/fields.h>

#include "fsw/control/solver_list.h"
#include "fsw/messaging/inbox.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/mission/attitude.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {

namespace {

using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;

template <class T>
T value_or_throw(const fsw::Result<T>& result, const mission::Spacecraft& spacecraft) {
  if (!result.ok()) throw std::runtime_error("spacecraft \"" + spacecraft.name + "\": its elements describe no orbit");
  return result.value();
}

CartesianState state_of(const QnsElements& mean, const mission::Spacecraft& spacecraft) {
  const QnsElements osculating = value_or_throw(fsw::orbit::osculating_from_mean(mean), spacecraft);
  return value_or_throw(fsw::orbit::cartesian_from_qns(osculating), spacecraft);
}

CartesianState state_at_epoch(const mission::OrbitByElements& orbit, const mission::Spacecraft& spacecraft) {
  if (orbit.kind == mission::ElementsKind::kMean) return state_of(orbit.elements, spacecraft);
  return value_or_throw(fsw::orbit::cartesian_from_qns(orbit.elements), spacecraft);
}

std::string note_of(const orbit_files::InterpolationCheck& check, const std::string& file,
                    const std::string& spacecraft) {
  const std::string velocity = check.bound_mps ? fmt::format(" and {:.1e} m/s", *check.bound_mps) : "";
  return fmt::format(
      "The orbit of {} is interpolated between states of {} {:g} s apart, by the {}{}: good to {:.1e} m{}, by states "
      "left out and found again.",
      spacecraft, file, check.step_s, name_of(check.rule), check.rule.is_published ? " that the file states" : "",
      check.bound_m, velocity);
}

CartesianState state_at_epoch(const mission::OrbitByFile& orbit, const mission::Spacecraft& spacecraft,
                              const std::filesystem::path& data_directory, truth::TruthModel& truth) {
  const auto file = orbit_files::tracks_of(orbit_files::load_orbits(data_directory / orbit.file), orbit.object);
  const orbit_files::FramedState at = orbit_files::state_at(file, truth.time());
  if (at.interpolation) truth.add_data_note(note_of(*at.interpolation, orbit.file.filename(), spacecraft.name));
  truth::EarthRotation rotation(truth.data().earth_orientation, truth.time());
  return orbit_files::gcrf_state(at.frame, at.state, rotation, 0.0);
}

/// Mean ROE of `spacecraft` with respect to another one; none if its orbit is given by elements.
std::optional<mission::OrbitByRoe> relative_orbit(const mission::Mission& mission,
                                                  const mission::Spacecraft& spacecraft) {
  if (const auto* by_roe = std::get_if<mission::OrbitByRoe>(&spacecraft.orbit)) return *by_roe;
  const auto* const by_waypoint = std::get_if<mission::OrbitByWaypoint>(&spacecraft.orbit);
  if (by_waypoint == nullptr) return std::nullopt;
  const mission::Waypoint* waypoint = mission.find_waypoint(by_waypoint->waypoint_index);
  if (waypoint == nullptr) throw std::runtime_error("spacecraft \"" + spacecraft.name + "\": no such waypoint");
  return mission::OrbitByRoe{by_waypoint->to, waypoint->a_roe_m};
}

CartesianState state_about(const mission::Mission& mission, const mission::OrbitByRoe& orbit,
                           const mission::Spacecraft& spacecraft, const truth::TruthModel& truth) {
  const QnsElements chief_osculating =
      value_or_throw(fsw::orbit::qns_from_cartesian(truth.state(orbit.to)), spacecraft);
  const QnsElements chief_mean = value_or_throw(fsw::orbit::mean_from_osculating(chief_osculating), spacecraft);
  const fsw::Vector6 roe = orbit.a_roe_m / mission.guidance.reference_semi_major_axis_m;
  return state_of(fsw::orbit::qns_from_roe(chief_mean, roe), spacecraft);
}

}  // namespace

truth::SurfaceProperties true_surface(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  truth::SurfaceProperties surface = spacecraft.surface;
  surface.mass_kg += mission::drawn_mass_error_kg(mission.seed, spacecraft.name, spacecraft.mass_sigma_kg);
  if (!(surface.mass_kg > 0.0))
    throw std::runtime_error("spacecraft \"" + spacecraft.name +
                             "\": the mass drawn with its mass_sigma_kg is not positive");
  return surface;
}

namespace {

truth::SpacecraftSettings settings_of(const mission::Mission& mission, const mission::Spacecraft& spacecraft,
                                      const CartesianState& state) {
  const bool burns_last = spacecraft.thruster && spacecraft.thruster->finite;
  return {spacecraft.name, state, true_surface(mission, spacecraft), burns_last};
}

}  // namespace

truth::TruthSettings truth_settings(const mission::Mission& mission, const std::filesystem::path& data_directory) {
  mission::check_data_files(mission, data_directory);
  truth::TruthSettings settings = mission.truth;
  settings.data_directory = data_directory;
  return settings;
}

void place_spacecraft(const mission::Mission& mission, const std::filesystem::path& data_directory,
                      truth::TruthModel& truth) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (const auto* orbit = std::get_if<mission::OrbitByElements>(&spacecraft.orbit)) {
      truth.add_spacecraft(settings_of(mission, spacecraft, state_at_epoch(*orbit, spacecraft)));
    }
    if (const auto* orbit = std::get_if<mission::OrbitByFile>(&spacecraft.orbit)) {
      truth.add_spacecraft(settings_of(mission, spacecraft, state_at_epoch(*orbit, spacecraft, data_directory, truth)));
    }
  }
  truth.advance_to(mission.start_time());
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (const auto orbit = relative_orbit(mission, spacecraft)) {
      truth.add_spacecraft(settings_of(mission, spacecraft, state_about(mission, *orbit, spacecraft, truth)));
    }
  }
}

namespace {

/// Converts the attitude of one spacecraft from the mission file to the settings of the truth.
struct SettingsOf {
  const mission::Mission& mission;
  const mission::Spacecraft& spacecraft;
  const std::filesystem::path& data_directory;

  truth::AttitudeSettings operator()(const mission::Tumble& tumble) const {
    truth::TumbleSettings settings;
    settings.body = mission::load_body(mission::body_file_of(data_directory, tumble.body));
    if (tumble.inertia_kgm2) settings.body.inertia_kgm2 = *tumble.inertia_kgm2;
    settings.torques = tumble.torques;
    settings.drag_coefficient = spacecraft.surface.drag_coefficient;
    settings.start = mission::start_of(tumble, mission.seed, spacecraft.name);
    return settings;
  }

  truth::InertialSettings operator()(const mission::Inertial& inertial) const {
    return truth::InertialSettings{inertial.q_body_eci ? *inertial.q_body_eci
                                                       : mission::drawn_attitude(mission.seed, spacecraft.name)};
  }

  truth::PointedSettings operator()(const truth::PointedSettings& pointed) const { return pointed; }

  truth::AttitudeSettings operator()(const mission::Commanded& commanded) const {
    return truth::CommandedSettings{
        commanded.axes, mission::drawn_control_error(mission.seed, spacecraft.name, commanded.control_error)};
  }
};

}  // namespace

void set_attitudes(const mission::Mission& mission, const std::filesystem::path& data_directory,
                   truth::TruthModel& truth) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (!spacecraft.attitude) continue;
    const SettingsOf settings_of{mission, spacecraft, data_directory};
    const auto settings =
        std::visit([&](const auto& one) { return truth::AttitudeSettings(settings_of(one)); }, *spacecraft.attitude);
    std::vector<truth::LaterAttitudeSettings> later;
    for (const mission::LaterAttitude& one : spacecraft.later_attitudes) {
      truth::LaterAttitudeSettings& added = later.emplace_back();
      added.from_s = one.from_s;
      added.slew_s = one.slew_s;
      std::visit([&](const auto& profile) { added.attitude = settings_of(profile); }, one.profile);
    }
    try {
      truth.set_attitude(truth.index_of(spacecraft.name), settings, later);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error("spacecraft \"" + spacecraft.name + "\", attitude: " + error.what());
    }
  }
}

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
      "spacecraft \"{}\": its mean inclination is {:.6f} deg; accepted: {} to {} deg, where the relative orbital "
      "elements of this flight software are regular (its control error grows as 1 / sin i); flight_computer.library "
      "may name another one",
      spacecraft, inclination_deg, kMinInclination_deg, 180.0 - kMinInclination_deg));
}

/// The packets of a run that lasts longer are all refused.
void check_packet_times(const mission::Mission& mission) {
  if (mission.end_time() <= fsw::messaging::kLatestTime) return;
  throw std::runtime_error(
      fmt::format("mission.epoch_utc: the run ends at {}; accepted: up to {}, the last time that "
                  "packets of the flight software carry",
                  truth::format_utc(mission.end_time(), 0), truth::format_utc(fsw::messaging::kLatestTime, 0)));
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
