#include "host_sim/mission/initial_states.h"

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"

namespace vbar::mission {

using fsw::Result;
using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;

Result<CartesianState> state_at_epoch(const OrbitByElements& orbit) {
  if (orbit.kind == ElementsKind::kOsculating) return fsw::orbit::cartesian_from_qns(orbit.elements);
  const Result<QnsElements> osculating = fsw::orbit::osculating_from_mean(orbit.elements);
  if (!osculating.ok()) return osculating.status();
  return fsw::orbit::cartesian_from_qns(osculating.value());
}

Result<CartesianState> state_at_waypoint(const Mission& mission, const OrbitByWaypoint& orbit,
                                         const CartesianState& reference) {
  const Waypoint* waypoint = mission.find_waypoint(orbit.waypoint_index);
  if (waypoint == nullptr) return fsw::Status::kInvalidArgument;
  const Result<QnsElements> reference_osculating = fsw::orbit::qns_from_cartesian(reference);
  if (!reference_osculating.ok()) return reference_osculating.status();
  const Result<QnsElements> reference_mean = fsw::orbit::mean_from_osculating(reference_osculating.value());
  if (!reference_mean.ok()) return reference_mean.status();
  const fsw::Vector6 roe = waypoint->a_roe_m / mission.guidance.reference_semi_major_axis_m;
  return state_at_epoch({ElementsKind::kMean, fsw::orbit::qns_from_roe(reference_mean.value(), roe)});
}

}  // namespace vbar::mission
