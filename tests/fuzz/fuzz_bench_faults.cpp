// Lines on the bench's control line of faults, with arbitrary contents. Promise: a fault that fits its rule, or one
// MissionError.

#include <string>
#include <vector>

#include "emulators/grand/generator/scenario.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::grand::bench;
  const std::vector<std::string> vehicles{"servicer", "target"};
  try {
    const Fault fault = fault_from_json(std::string(data, data + size), vehicles);
    const FaultRule& rule = rule_of(fault.kind);
    VBAR_FUZZ_EXPECT(fault.vehicle < vehicles.size() && fault.port < 2);
    VBAR_FUZZ_EXPECT(fault.duration.ns >= 0);
    VBAR_FUZZ_EXPECT(rule.value_key.empty() ||
                     (fault.value >= rule.value_range.low && fault.value <= rule.value_range.high));
  } catch (const vbar::mission::MissionError&) {
  }
  return 0;
}
