#include "host_sim/app/initial_orbits.h"

#include <optional>
#include <stdexcept>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/mission/attitude.h"

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

/// With the true mass.
truth::SurfaceProperties true_surface(const mission::Mission& mission, const mission::Spacecraft& spacecraft) {
  truth::SurfaceProperties surface = spacecraft.surface;
  surface.mass_kg += mission::drawn_mass_error_kg(mission.seed, spacecraft.name, spacecraft.mass_sigma_kg);
  if (!(surface.mass_kg > 0.0))
    throw std::runtime_error("spacecraft \"" + spacecraft.name +
                             "\": the mass drawn with its mass_sigma_kg is not positive");
  return surface;
}

}  // namespace

truth::TruthSettings truth_settings(const mission::Mission& mission, const std::filesystem::path& data_directory) {
  truth::TruthSettings settings = mission.truth;
  settings.data_directory = data_directory;
  return settings;
}

void place_spacecraft(const mission::Mission& mission, truth::TruthModel& truth) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (const auto* orbit = std::get_if<mission::OrbitByElements>(&spacecraft.orbit)) {
      truth.add_spacecraft({spacecraft.name, state_at_epoch(*orbit, spacecraft), true_surface(mission, spacecraft)});
    }
  }
  truth.advance_to(mission.start_time());
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (const auto orbit = relative_orbit(mission, spacecraft)) {
      truth.add_spacecraft(
          {spacecraft.name, state_about(mission, *orbit, spacecraft, truth), true_surface(mission, spacecraft)});
    }
  }
}

}  // namespace vbar::app
