// Lines on the control line of the optical bench, and framebuffer files, with arbitrary contents. Promise: a fault that
// fits its rule or one MissionError; a layout whose pixels are in the file or one error.

#include <span>
#include <stdexcept>
#include <string>

#include "emulators/optical_stimulator/faults.h"
#include "emulators/optical_stimulator/screen.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::optical_stimulator::bench;
  try {
    const Fault fault = fault_from_json(std::string(data, data + size));
    const FaultRule& rule = rule_of(fault.kind);
    VBAR_FUZZ_EXPECT(fault.axis < 2 && fault.duration_s >= 0.0);
    VBAR_FUZZ_EXPECT(rule.value_key.empty() ||
                     (fault.value >= rule.value_range.low && fault.value <= rule.value_range.high));
  } catch (const vbar::mission::MissionError&) {
  }
  const std::span<const std::uint8_t> file(data, size);
  try {
    const XwdLayout layout = read_xwd_layout(file);
    std::vector<std::uint8_t> grey;
    read_grey(file, layout, grey);
    VBAR_FUZZ_EXPECT(grey.size() == static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height));
  } catch (const std::runtime_error&) {
  }
  return 0;
}
