#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;

constexpr int kIterations = 12;
constexpr int kLongestChain = 3;  // spacecraft, each placed about the next

/// Mean elements of a spacecraft that coasts, at `time`; none where its orbit is that of a file or does not exist.
std::optional<QnsElements> mean_orbit(const Mission& mission, const std::string& name, fsw::GpsTime time, int depth) {
  const Spacecraft* const spacecraft = mission.find_spacecraft(name);
  if (spacecraft == nullptr || depth == 0) return std::nullopt;
  if (const auto* const by_elements = std::get_if<OrbitByElements>(&spacecraft->orbit)) {
    const auto mean = by_elements->kind == ElementsKind::kMean
                          ? fsw::Result<QnsElements>(by_elements->elements)
                          : fsw::orbit::mean_from_osculating(by_elements->elements);
    if (!mean.ok()) return std::nullopt;
    return fsw::orbit::propagate_secular(mean.value(), fsw::seconds(time - mission.epoch));
  }
  // Placed about another one at the start.
  std::string to;
  fsw::Vector6 a_roe_m = fsw::Vector6::Zero();
  if (const auto* const by_roe = std::get_if<OrbitByRoe>(&spacecraft->orbit)) {
    to = by_roe->to;
    a_roe_m = by_roe->a_roe_m;
  } else if (const auto* const by_waypoint = std::get_if<OrbitByWaypoint>(&spacecraft->orbit)) {
    const Waypoint* const waypoint = mission.find_waypoint(by_waypoint->waypoint_index);
    if (waypoint == nullptr) return std::nullopt;
    to = by_waypoint->to;
    a_roe_m = waypoint->a_roe_m;
  }
  const auto chief = mean_orbit(mission, to, mission.start_time(), depth - 1);
  if (!chief) return std::nullopt;
  const fsw::Vector6 roe = a_roe_m / mission.guidance.reference_semi_major_axis_m;
  return fsw::orbit::propagate_secular(fsw::orbit::qns_from_roe(*chief, roe),
                                       fsw::seconds(time - mission.start_time()));
}

/// Mean ROE of a target that has this state in the RTN of a servicer with these mean elements.
std::optional<fsw::Vector6> roe_about(const QnsElements& servicer_mean, const fsw::orbit::RelativeState& target_rtn) {
  const auto osculating = fsw::orbit::osculating_from_mean(servicer_mean);
  if (!osculating.ok()) return std::nullopt;
  const auto servicer = fsw::orbit::cartesian_from_qns(osculating.value());
  if (!servicer.ok()) return std::nullopt;
  const CartesianState& chief = servicer.value();
  const fsw::Matrix3 R_eci_rtn = fsw::orbit::R_rtn_eci(chief).transpose();
  const fsw::Vector3 rate_eci = chief.position_eci.cross(chief.velocity_eci) / chief.position_eci.squaredNorm();
  const fsw::Vector3 offset_eci = R_eci_rtn * target_rtn.position_rtn;
  const CartesianState target{chief.position_eci + offset_eci,
                              chief.velocity_eci + R_eci_rtn * target_rtn.velocity_rtn + rate_eci.cross(offset_eci)};
  const auto target_osculating = fsw::orbit::qns_from_cartesian(target);
  if (!target_osculating.ok()) return std::nullopt;
  const auto target_mean = fsw::orbit::mean_from_osculating(target_osculating.value());
  if (!target_mean.ok()) return std::nullopt;
  return fsw::orbit::roe_from_qns(servicer_mean, target_mean.value());
}

/// Moves the servicer until the target, seen from it, is where it is.
std::optional<fsw::Vector6> roe_of(const QnsElements& target_mean, const fsw::orbit::RelativeState& target_rtn) {
  QnsElements servicer = target_mean;
  std::optional<fsw::Vector6> roe;
  for (int k = 0; k < kIterations; ++k) {
    roe = roe_about(servicer, target_rtn);
    if (!roe) return std::nullopt;
    const QnsElements target = fsw::orbit::qns_from_roe(servicer, *roe);
    servicer.a -= target.a - target_mean.a;
    servicer.ex -= target.ex - target_mean.ex;
    servicer.ey -= target.ey - target_mean.ey;
    servicer.i -= target.i - target_mean.i;
    servicer.raan -= target.raan - target_mean.raan;
    servicer.u -= target.u - target_mean.u;
  }
  return roe_about(servicer, target_rtn);
}

}  // namespace

std::optional<fsw::orbit::RelativeState> target_in_rtn(const TableReader& waypoint) {
  constexpr double kLargest_m = 1e5;  // beyond, relative elements are to be stated
  const bool has_velocity = waypoint.has("velocity_rtn_mps");
  if (!waypoint.has("position_rtn_m")) {
    if (has_velocity) waypoint.refuse("velocity_rtn_mps", "a velocity without position_rtn_m", "both, or a_roe_m");
    return std::nullopt;
  }
  if (waypoint.has("a_roe_m")) waypoint.refuse("position_rtn_m", "both position_rtn_m and a_roe_m", "one of them");
  const auto position_m = waypoint.three_numbers("position_rtn_m", from_to(-kLargest_m, kLargest_m));
  const auto velocity_mps = waypoint.three_numbers("velocity_rtn_mps", from_to(-100.0, 100.0));
  return fsw::orbit::RelativeState{Eigen::Map<const fsw::Vector3>(position_m.data()),
                                   Eigen::Map<const fsw::Vector3>(velocity_mps.data())};
}

void place_rtn_waypoints(const TableReader& document, Mission& mission) {
  const std::vector<TableReader> sections = document.tables("waypoint");
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const auto target_rtn = target_in_rtn(sections[k]);
    if (!target_rtn) continue;
    const auto refuse = [&](const std::string& found, const std::string& accepted) {
      sections[k].refuse("position_rtn_m", found, accepted);
    };
    const auto servicer =
        std::ranges::find_if(mission.spacecraft, [](const Spacecraft& s) { return !!s.flight_computer; });
    if (servicer == mission.spacecraft.end()) refuse("no spacecraft with a flight computer", "a_roe_m");
    Waypoint& waypoint = mission.waypoints[k];
    const bool is_at_start = waypoint.time == mission.start_time();
    // At the start the servicer has not manoeuvred, and the target may be placed by this very waypoint.
    const std::string known = is_at_start ? servicer->name : servicer->observes();
    const auto orbit = mean_orbit(mission, known, waypoint.time, kLongestChain);
    if (!orbit) refuse("no mean orbit of " + known, "spacecraft by elements, or about one by elements; else a_roe_m");
    const auto roe = is_at_start ? roe_about(*orbit, *target_rtn) : roe_of(*orbit, *target_rtn);
    if (!roe) refuse("a state that is no orbit", "a target near the servicer");
    waypoint.a_roe_m = mission.guidance.reference_semi_major_axis_m * *roe;
  }
}

}  // namespace vbar::mission
