// The mission loader on an arbitrary text. Promise: a mission, or a MissionError of one line.

#include <string>
#include <string_view>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // Other files are another target's.
  if (text.find("extends") != std::string_view::npos) return 0;
  try {
    const auto mission = vbar::sensors::parse_mission(text, "/fuzz/fuzz.toml");
    VBAR_FUZZ_EXPECT(mission.step.shortest_period().ns > 0 && mission.duration.ns > 0);
  } catch (const vbar::mission::MissionError& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).starts_with("/fuzz/"));
  }
  return 0;
}
