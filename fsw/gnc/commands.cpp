// command: maneuvers, pointing and exposures, each sent and noted by those who must expect its effect.

#include "fsw/gnc/gnc.h"
#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::gnc {

void Gnc::command_maneuvers() {
  for (std::size_t k = 0; k < guidance_.command_count(); ++k) {
    const guidance::CommandedBurn& commanded = guidance_.command(k);
    const Vector3 dv_rtn = command_for(commanded.burn.dv_rtn);
    navigation_.expect_maneuver(commanded.maneuver_id, commanded.burn.time, commanded.burn.dv_rtn);
    burns_.expect(commanded.maneuver_id, commanded.burn.time, dv_rtn, guidance_.end_of(commanded.burn));
    safety_monitor_.take_command(commanded.maneuver_id, dv_rtn);
    maneuver_command message{};
    message.maneuver_id = commanded.maneuver_id;
    message.waypoint_index = commanded.waypoint_index;
    message.solver = static_cast<std::int8_t>(commanded.solver);
    messaging::copy(dv_rtn, message.dv_rtn);
    outbox_.send(commanded.burn.time, message);
  }
}

Vector3 Gnc::command_for(const Vector3& dv_rtn) const {
  const bool is_off = (faults_.latched() & telemetry_health::kFaultBurnSize) != 0;
  return is_off ? Vector3(dv_rtn / burns_.scale().scale()) : dv_rtn;
}

std::optional<measurements::Pointing> Gnc::pointing_to_target() const {
  const navigation::NavigationState& state = navigation_.state();
  if (state.has_target) {
    const Result<measurements::Pointing> pointing = measurements::pointing_at(now_, state.servicer, state.target);
    if (!pointing.ok()) return std::nullopt;
    return measurements_.source<measurements::BearingSource>().searched(pointing.value());
  }
  const auto& last_seen_rtn = measurements_.source<measurements::KeypointSource>().last_seen_rtn();
  if (!last_seen_rtn) return std::nullopt;
  return measurements::Pointing{.time = now_, .boresight_rtn = *last_seen_rtn};
}

/// Points at the estimated position of the target, not at that of the last image: it moves between images; at where it
/// may be if it was lost.
void Gnc::point_camera() {
  const std::optional<measurements::Pointing> pointing = pointing_to_target();
  if (!pointing) return;
  measurements_.set_pointing(*pointing);
  pointing_command message{};
  messaging::copy(pointing->boresight_rtn, message.boresight_rtn);
  messaging::copy(pointing->boresight_rate_rtn, message.boresight_rate_rtn);
  outbox_.send(now_, message);
}

void Gnc::command_exposures() {
  const auto& keypoints = measurements_.source<measurements::KeypointSource>();
  for (std::size_t camera = 0; camera < packets::kCameras; ++camera) {
    const std::optional<double> exposure_s = keypoints.wanted_exposure_s(camera);
    if (exposure_s) outbox_.send(now_, exposure_command{.exposure_s = *exposure_s}, static_cast<std::uint8_t>(camera));
  }
}

}  // namespace vbar::fsw::gnc
