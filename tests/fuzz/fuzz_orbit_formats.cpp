// OEM, OPM and SP3 with arbitrary contents. Promise: tracks in ascending order of time that can be interpolated in
// their middle or refuse it with one std::out_of_range, or one exception that names the file.

#include <exception>
#include <stdexcept>
#include <string_view>

#include "host_sim/orbit_files/orbit_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::orbit_files;

void check(const OrbitFile& file) {
  VBAR_FUZZ_EXPECT(!file.tracks.empty());
  for (const Track& track : file.tracks) {
    VBAR_FUZZ_EXPECT(!track.states.empty());
    for (std::size_t k = 0; k < track.states.size(); ++k) {
      VBAR_FUZZ_EXPECT(k == 0 || track.states[k - 1].time < track.states[k].time);
      VBAR_FUZZ_EXPECT(track.states[k].state.position_eci.allFinite() &&
                       track.states[k].state.velocity_eci.allFinite());
    }
    const OrbitFile one{file.file, file.format, {track}};
    const auto span = track.states.back().time - track.states.front().time;
    try {
      static_cast<void>(state_at(one, track.states.front().time + vbar::fsw::Duration{span.ns / 3}));
    } catch (const std::out_of_range&) {
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    check(read_orbits(text, "file.txt"));
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
  }
  return 0;
}
