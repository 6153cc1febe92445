#pragma once
// Testbeds whose drivers need libraries of displays and cameras. A program has these drivers if it links the object
// vbar_hil_benches (bench_kinds.cpp), as vbar_hil does; otherwise the library of testbeds gives it stand-ins
// (bench_kinds_elsewhere.cpp).

#include <memory>
#include <span>

#include "hil_drivers/testbed.h"

namespace vbar::testbeds {

[[nodiscard]] std::span<const TestbedKind* const> bench_kinds();

/// Reads nothing: TestbedKind::read of a stand-in. Throws DriverElsewhere if vbar_hil is beside this program, otherwise
/// MissionError.
std::shared_ptr<const mission::TestbedSettings> read_without_driver(const mission::TableReader& section);

}  // namespace vbar::testbeds
