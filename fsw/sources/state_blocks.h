#pragma once
// The list of the state blocks of all measurement sources. A new block is a struct beside its source and a place in the
// list below; the order is that of the state.

#include "fsw/estimation/layout.h"
#include "fsw/sources/bearings/bearing_blocks.h"
#include "fsw/sources/carrier_pair/carrier_blocks.h"
#include "fsw/sources/keypoints/keypoint_blocks.h"
#include "fsw/sources/range_finder/range_blocks.h"

namespace vbar::fsw::sources {

using MeasurementBlocks =
    estimation::Layout<KeypointOrigin, BearingBias, CameraMounts, BrightnessOffset, CentroidWander, KeypointCommon,
                       KeypointErrors, RangeBias, ServicerAntenna, TargetAntenna, PhaseCentreJitter, ClockDifference,
                       CodeBiases, Ionosphere, Ambiguities, PhaseWander>;

/// Most measurements of one batch: two of each keypoint.
inline constexpr int kMaxMeasurements = KeypointErrors::kSize;

}  // namespace vbar::fsw::sources
