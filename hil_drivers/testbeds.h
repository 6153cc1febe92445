#pragma once
// The list of testbeds and of the clocks that they bring.

#include "host_sim/sensors/installed_testbeds.h"

namespace vbar::testbeds {

/// Drivers of this program, for testbeds::install; those of the object vbar_hil_benches as far as it is linked
/// (bench_kinds.h).
[[nodiscard]] Drivers drivers();

}  // namespace vbar::testbeds
