// Broadcast ephemerides with arbitrary contents. Promise: each satellite once or, in the project's own table, as it is
// listed, on an orbit, or one exception that names the file.

#include <cmath>
#include <exception>
#include <string_view>

#include "host_sim/twins/gnss/ephemeris_file.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::twins::gnss;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const EphemerisFile file = read_ephemerides(text, "file.txt");
    VBAR_FUZZ_EXPECT(!file.satellites.empty());
    for (const Ephemeris& set : file.satellites) {
      VBAR_FUZZ_EXPECT(set.satellite.prn >= 1 && set.satellite.prn <= 63);
      VBAR_FUZZ_EXPECT(set.sqrt_a > 2000.0 && set.sqrt_a < 9000.0 && set.e >= 0.0 && set.e < kMaxEccentricity);
      VBAR_FUZZ_EXPECT(set.toe.ns >= 0);
    }
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
  }
  return 0;
}
