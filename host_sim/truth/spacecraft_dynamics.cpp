#include "host_sim/truth/spacecraft_dynamics.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/gve.h"
#include "host_sim/truth/orbit_geometry.h"

namespace vbar::truth {

SpacecraftDynamics::SpacecraftDynamics(std::string name, double gm, double earth_radius, EarthRotation earth_rotation,
                                       std::vector<std::unique_ptr<Force>> forces)
    : name_(std::move(name)),
      gm_(gm),
      earth_radius_(earth_radius),
      earth_rotation_(std::move(earth_rotation)),
      forces_(std::move(forces)) {}

fsw::Vector6 SpacecraftDynamics::element_rates(double seconds, const fsw::Vector6& elements) {
  const fsw::orbit::QnsElements osculating = elements_from_vector(elements);
  const OrbitGeometry geometry = orbit_geometry(osculating, gm_);
  const fsw::Vector3 perturbation = perturbation_eci(seconds, geometry.state);
  return gve_rates(osculating, geometry, geometry.R_rtn_eci * perturbation);
}

fsw::Vector3 SpacecraftDynamics::perturbation_eci(double seconds, const fsw::orbit::CartesianState& state) {
  // Written so that a state that is not a number is refused as well.
  if (!(state.position_eci.norm() > earth_radius_)) {
    throw std::domain_error(
        fmt::format("re-enters: distance from the Earth's centre {:.0f} m, {:.1f} s after the epoch",
                    state.position_eci.norm(), seconds));
  }
  ForceInput input;
  input.seconds = seconds;
  input.position_eci = state.position_eci;
  input.velocity_eci = state.velocity_eci;
  input.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(seconds);
  input.position_itrf = input.R_itrf_gcrf * state.position_eci;
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (const auto& force : forces_) sum += force->acceleration_eci(input);
  return sum;
}

}  // namespace vbar::truth
