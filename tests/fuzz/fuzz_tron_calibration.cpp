// A calibration file of TRON with arbitrary contents. Promise: a calibration that its writer gives again and whose
// chain gives finite poses, or one MissionError.

#include <string_view>

#include "hil_drivers/tron/geometry/calibration.h"
#include "host_sim/mission/mission_error.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::tron;
  try {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const Calibration calibration = parse_calibration(text, "calibration.toml");
    const std::string written = toml_of(calibration);
    VBAR_FUZZ_EXPECT(toml_of(parse_calibration(written, "written.toml")) == written);
    Posture posture;
    posture.camera_rad.setConstant(0.3);
    posture.target_rad.setConstant(-1.2);
    for (const double carriage_m : {-1e3, 0.5, 4.0, 7.5, 1e3}) {
      posture.carriage_m = carriage_m;
      VBAR_FUZZ_EXPECT(T_C_T_of_arms(calibration, posture).matrix().allFinite());
    }
  } catch (const vbar::mission::MissionError&) {
  }
  return 0;
}
