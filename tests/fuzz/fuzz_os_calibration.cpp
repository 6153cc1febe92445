// A calibration file of the Optical Stimulator with arbitrary contents. Promise: a calibration that its writer gives
// again and whose map has an inverse, or one MissionError.

#include <string_view>

#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::optical_stimulator;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const StimulatorCalibration calibration = parse_calibration(text, "calibration.toml");
    const std::string written = toml_of(calibration);
    VBAR_FUZZ_EXPECT(toml_of(parse_calibration(written, "written.toml")) == written);
    const DisplayMap map(calibration.geometry);
    VBAR_FUZZ_EXPECT(map.direction_of({0.0, 0.0}).allFinite());
    VBAR_FUZZ_EXPECT(calibration.uniformity.at({100.0, -3.0}) > 0.0);
  } catch (const vbar::mission::MissionError&) {
  }
  return 0;
}
