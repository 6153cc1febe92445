#include "host_sim/twins/actuator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "host_sim/engine/random_stream.h"

namespace vbar::twins {

fsw::Vector3 BurnErrors::applied_to(const fsw::Vector3& dv_rtn, std::int32_t maneuver_id,
                                    const engine::RandomStream& stream, std::vector<Note>& notes) const {
  const double dv = dv_rtn.norm();
  const bool perfect = magnitude == 0.0 && pointing_rad == 0.0;
  if (perfect || dv == 0.0) return dv_rtn;

  const auto uniforms = stream.uniforms_of(static_cast<std::uint32_t>(maneuver_id));
  const double magnitude_error = magnitude * engine::normal_quantile(uniforms[0]);
  // A tilt vector across the impulse: its length is the angle.
  const fsw::Vector3 direction = dv_rtn / dv;
  const fsw::Vector3 across_1 = direction.unitOrthogonal();
  const fsw::Vector3 across_2 = direction.cross(across_1);
  const fsw::Vector3 tilt = pointing_rad * (engine::normal_quantile(uniforms[1]) * across_1 +
                                            engine::normal_quantile(uniforms[2]) * across_2);
  const double angle = tilt.norm();
  notes.push_back({"magnitude_error", magnitude_error});
  notes.push_back({"pointing_error_rad", angle});
  const fsw::Vector3 tilted =
      angle == 0.0 ? direction : fsw::Vector3(std::cos(angle) * direction + std::sin(angle) * (tilt / angle));
  return dv * (1.0 + magnitude_error) * tilted;
}

IdealThruster::IdealThruster(const Settings& settings, const engine::RandomStream& stream)
    : settings_(settings), stream_(stream), encoder_(settings.spacecraft_number, settings.unit) {}

Execution IdealThruster::execute(const vbar::maneuver_command& command, fsw::GpsTime burn_time, fsw::GpsTime now) {
  Execution execution;
  execution.time = burn_time;
  execution.maneuver.maneuver_id = command.maneuver_id;
  if (burn_time >= now) {
    execution.maneuver.accepted = 1;
    const fsw::Vector3 dv_rtn = settings_.errors.applied_to(Eigen::Map<const fsw::Vector3>(command.dv_rtn),
                                                            command.maneuver_id, stream_, execution.notes);
    std::copy(dv_rtn.begin(), dv_rtn.end(), execution.maneuver.dv_rtn);
  }
  std::optional<Packet> packet = encoder_.encode(burn_time, execution.maneuver);
  if (!packet) throw std::runtime_error("thruster: a maneuver command that is not finite");
  execution.packet = std::move(*packet);
  return execution;
}

}  // namespace vbar::twins
