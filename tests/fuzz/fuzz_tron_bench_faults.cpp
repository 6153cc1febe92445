// Lines on the control line of the robotic bench with arbitrary contents. Promise: a fault that fits its rule or one
// MissionError.

#include <string>

#include "emulators/tron/faults.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::tron::bench;
  try {
    const Fault fault = fault_from_json(std::string(data, data + size));
    const FaultRule& rule = rule_of(fault.kind);
    VBAR_FUZZ_EXPECT(fault.box < vbar::tron::kBoxes && fault.duration_s >= 0.0);
    VBAR_FUZZ_EXPECT(!fault.at_image || !fault.at_cycle);
    VBAR_FUZZ_EXPECT(rule.value_key.empty() ||
                     (fault.value >= rule.value_range.low && fault.value <= rule.value_range.high));
  } catch (const vbar::mission::MissionError&) {
  }
  return 0;
}
