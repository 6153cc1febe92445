#pragma once

#include "hil_drivers/testbed.h"

namespace vbar::external {

extern const testbeds::TestbedKind kExternal;

}  // namespace vbar::external
