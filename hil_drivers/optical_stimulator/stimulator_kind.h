#pragma once
// [testbed.optical_stimulator], registered in ../testbeds.cpp.

#include "hil_drivers/testbed.h"

namespace vbar::optical_stimulator {

extern const testbeds::TestbedKind kOpticalStimulator;

}  // namespace vbar::optical_stimulator
