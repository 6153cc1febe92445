// Published files of Earth orientation and space weather with arbitrary contents, both readers on each text. Promise:
// days without gaps whose values are finite, or one exception that names the file.

#include <cmath>
#include <exception>
#include <string_view>

#include "host_sim/truth/earth/orientation_formats.h"
#include "host_sim/truth/earth/weather_formats.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar::truth;

template <class Read>
void expect_data_or_message(const Read& read) {
  try {
    read();
  } catch (const std::exception& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("file.txt") != std::string_view::npos);
  }
}

void read_earth_orientation(std::string_view text) {
  const OrientationDays days = read_orientation(text, "file.txt");
  for (std::size_t k = 0; k < days.size(); ++k) {
    VBAR_FUZZ_EXPECT(days[k].mjd_utc == days[0].mjd_utc + static_cast<int>(k));
    const EarthOrientation& o = days[k].orientation;
    VBAR_FUZZ_EXPECT(std::isfinite(o.ut1_minus_tai_s + o.pole_x + o.pole_y + o.cip_dx + o.cip_dy));
  }
  if (days.size() >= 4) static_cast<void>(EarthOrientationSeries(days));
}

void read_space_weather(std::string_view text) {
  const WeatherDays days = read_weather(text, "file.txt");
  for (std::size_t k = 0; k < days.size(); ++k) {
    VBAR_FUZZ_EXPECT(days[k].mjd_utc == days[0].mjd_utc + static_cast<int>(k));
    VBAR_FUZZ_EXPECT(days[k].kind == SpaceWeather::Kind::kMissing || days[k].f107 > 0.0);
  }
  if (days.size() >= 4) static_cast<void>(SpaceWeather(days));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  expect_data_or_message([&] { read_earth_orientation(text); });
  expect_data_or_message([&] { read_space_weather(text); });
  return 0;
}
