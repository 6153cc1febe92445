#pragma once
// The truth of an image that the flight software has processed: the place of the target, and the errors of bearing,
// attitude and estimate.

#include <optional>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::sensors {

/// Fills the true part of `row` (range, errors, the object that is the target, the spacecraft that was chosen, NEES)
/// from the truth at the exposure. The truth must hold `servicer` and the spacecraft that it observes; without them, or
/// without an attitude, `row` stays as it is. `known`: the camera as calibrated on the ground; that of a testbed is
/// another than the mission's. `objects`: those of the same image, null if telemetry did not report them.
void add_truth(ImageRow& row, const telemetry_image& image, const telemetry_objects* objects, const CameraSensor& known,
               const mission::Spacecraft& servicer, const twins::TruthSnapshot& truth);

}  // namespace vbar::sensors
