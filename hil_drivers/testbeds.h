#pragma once
// The list of testbeds and of the clocks that they bring.

#include <memory>
#include <span>

#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/sensors/testbed.h"

namespace vbar::testbeds {

/// Drivers of this program, for testbeds::install; those of the object vbar_optional_testbeds as far as it is linked
/// (optional_testbeds.h).
[[nodiscard]] Drivers drivers();

// Testbeds whose drivers need libraries of displays and cameras. A program has these drivers if it links the object
// vbar_optional_testbeds (optional_testbeds.cpp), as vbar_hil does; otherwise the library of testbeds gives it
// stand-ins (optional_testbeds_missing.cpp).

[[nodiscard]] std::span<const TestbedKind* const> optional_testbeds();

/// Reads nothing: TestbedKind::read of a stand-in. Throws DriverElsewhere if vbar_hil is beside this program, otherwise
/// MissionError.
std::shared_ptr<const mission::TestbedSettings> read_without_driver(const mission::TableReader& section);

}  // namespace vbar::testbeds
