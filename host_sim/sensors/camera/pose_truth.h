#pragma once
// Telemetry of a pose and its keypoints, and their truth.

#include <vector>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

/// Appends eleven rows, without the truth.
void append_keypoints(double exposure_s, const telemetry_pose& pose, std::vector<KeypointRow>& rows);

/// Sets what was true at the exposure beside the row and the last eleven of `keypoints`, the row's own.
/// `keypoints_body_m`: from the target's centre of mass, as telecommanded. `known`: the lens through which the
/// keypoints were seen; that of a testbed's camera is another than the mission's. Nothing where the truth lacks an
/// attitude.
void add_truth(PoseRow& row, std::vector<KeypointRow>& keypoints, const telemetry_pose& pose,
               const double (&keypoints_body_m)[33], const CameraSensor& known, const mission::Spacecraft& servicer,
               const twins::TruthSnapshot& truth);

}  // namespace vbar::sensors
