#pragma once
// The list of the state blocks of all measurement sources. A new block is a struct beside its source and a place in the
// list below; the order is that of the state.

#include "fsw/estimation/state_layout.h"
#include "fsw/measurements/state_blocks/bearing_blocks.h"
#include "fsw/measurements/state_blocks/cdgnss_blocks.h"
#include "fsw/measurements/state_blocks/keypoint_blocks.h"
#include "fsw/measurements/state_blocks/range_blocks.h"

namespace vbar::fsw::measurements {

using MeasurementBlocks =
    estimation::Layout<KeypointOrigin, BearingBias, CameraMounts, BrightnessOffset, CentroidWander, EarthlightOffset,
                       KeypointCommon, KeypointErrors, RangeBias, ServicerAntenna, TargetAntenna, PhaseCentreJitter,
                       ClockDifference, CodeBiases, Ionosphere, Ambiguities, PhaseWander>;

/// Most measurements of one batch: two of each keypoint.
inline constexpr int kMaxMeasurements = KeypointErrors::kSize;

}  // namespace vbar::fsw::measurements
