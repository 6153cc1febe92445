// Observation files, plain and compact, with arbitrary contents. Promise: epochs in ascending order with the values of
// their types, or one exception that names the file.

#include <cmath>
#include <exception>
#include <string>
#include <string_view>

#include "host_sim/observation_files/rinex_observations.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vbar::observation_files;
  const std::string given(reinterpret_cast<const char*>(data), size);
  try {
    const std::string text = plain_observations(given, "file.txt");
    ObservationReader reader(text, "file.txt");
    vbar::fsw::GpsTime last{-1};
    while (const auto epoch = reader.next()) {
      VBAR_FUZZ_EXPECT(epoch->time > last);
      last = epoch->time;
      VBAR_FUZZ_EXPECT(epoch->satellites.size() <= static_cast<std::size_t>(ObservationReader::kMaxSatellites));
      for (const SatelliteObservations& satellite : epoch->satellites) {
        VBAR_FUZZ_EXPECT(satellite.values.size() == epoch->types->of(satellite.system).size());
        for (const ObservedValue& one : satellite.values)
          VBAR_FUZZ_EXPECT(std::isfinite(one.value) && one.loss_of_lock <= 9 && one.strength <= 9);
      }
    }
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
  }
  return 0;
}
