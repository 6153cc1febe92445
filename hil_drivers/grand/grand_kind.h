#pragma once
// [testbed.grand]: the GNSS testbed, registered in ../testbeds.cpp.

#include "hil_drivers/testbed.h"

namespace vbar::grand {

extern const testbeds::TestbedKind kGrand;

}  // namespace vbar::grand
