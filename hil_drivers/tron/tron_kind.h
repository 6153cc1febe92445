#pragma once
// TRON as a testbed of missions.

#include "hil_drivers/testbed.h"

namespace vbar::tron {

extern const testbeds::TestbedKind kTron;

}  // namespace vbar::tron
