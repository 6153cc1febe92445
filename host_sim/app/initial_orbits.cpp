#include "host_sim/app/initial_orbits.h"

#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "host_sim/mission/attitude.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/orbit_files/interpolation.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/truth/earth/earth_rotation.h"

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

/// Converts to GCRF from the Earth-fixed frame. The rate of the rotation is a central difference: over 0.1 s it is good
/// to 1e-8 m/s in a low orbit.
CartesianState gcrf_from_itrf(const CartesianState& itrf, const truth::TruthModel& truth, fsw::GpsTime time) {
  constexpr double kHalf_s = 0.1;
  truth::EarthRotation rotation(truth.data().earth_orientation, time);
  const fsw::Matrix3 R = rotation.R_itrf_gcrf_at(0.0);
  const fsw::Matrix3 rate = (rotation.R_itrf_gcrf_at(kHalf_s) - rotation.R_itrf_gcrf_at(-kHalf_s)) / (2.0 * kHalf_s);
  CartesianState state;
  state.position_eci = R.transpose() * itrf.position_eci;
  state.velocity_eci = R.transpose() * itrf.velocity_eci + rate.transpose() * itrf.position_eci;
  return state;
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
  return at.frame == orbit_files::Frame::kItrf ? gcrf_from_itrf(at.state, truth, truth.time()) : at.state;
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

/// Returns the surface properties with the true mass.
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
  mission::check_data_files(mission, data_directory);
  truth::TruthSettings settings = mission.truth;
  settings.data_directory = data_directory;
  return settings;
}

void place_spacecraft(const mission::Mission& mission, const std::filesystem::path& data_directory,
                      truth::TruthModel& truth) {
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    if (const auto* orbit = std::get_if<mission::OrbitByElements>(&spacecraft.orbit)) {
      truth.add_spacecraft({spacecraft.name, state_at_epoch(*orbit, spacecraft), true_surface(mission, spacecraft)});
    }
    if (const auto* orbit = std::get_if<mission::OrbitByFile>(&spacecraft.orbit)) {
      truth.add_spacecraft({spacecraft.name, state_at_epoch(*orbit, spacecraft, data_directory, truth),
                            true_surface(mission, spacecraft)});
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
