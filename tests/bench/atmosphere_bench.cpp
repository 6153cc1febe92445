// The atmosphere's cost: NRLMSISE-00 at places and times that change from call to call, as on an orbit, on one day;
// with daily and three-hourly indices; on the first call of a new day; and a whole drag acceleration.

#include <cmath>
#include <filesystem>
#include <memory>

#include <benchmark/benchmark.h>

#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/drag_force.h"
#include "tests/support/paths.h"

namespace {

namespace truth = vbar::truth;
using truth::GeomagneticIndex;

const std::filesystem::path kData = std::filesystem::path(vbar::tests::source_path("data"));

std::shared_ptr<const truth::Nrlmsise00Tables> tables() {
  return std::make_shared<const truth::Nrlmsise00Tables>(
      truth::load_nrlmsise00_tables(kData / "atmosphere/nrlmsise00.csv"));
}

truth::AtmosphereInput input_at(double altitude_km, GeomagneticIndex index) {
  truth::AtmosphereInput input;
  input.day_of_year = 199;
  input.altitude_km = altitude_km;
  input.indices = {103.6, 96.3, index, 6.0, {5.0, 9.0, 6.0, 9.0, 4.0, 4.0}};
  return input;
}

/// Moves on by 20 s of a polar orbit.
void move_on(truth::AtmosphereInput& input) {
  input.ut_s = input.ut_s < 86380.0 ? input.ut_s + 20.0 : 0.0;
  input.latitude_deg = 80.0 * std::sin(1e-3 * input.ut_s);
  input.longitude_deg = 180.0 - input.ut_s / 240.0;
  input.local_solar_time_h = input.ut_s / 3600.0 + input.longitude_deg / 15.0;
}

void nrlmsise00(benchmark::State& state, double altitude_km, GeomagneticIndex index) {
  truth::Nrlmsise00 model(tables());
  truth::AtmosphereInput input = input_at(altitude_km, index);
  for (auto _ : state) {
    move_on(input);
    benchmark::DoNotOptimize(model.at(input));
  }
}

void nrlmsise00_new_day(benchmark::State& state) {
  truth::Nrlmsise00 model(tables());
  truth::AtmosphereInput input = input_at(400.0, GeomagneticIndex::kDaily);
  for (auto _ : state) {
    input.day_of_year = input.day_of_year % 365 + 1;
    benchmark::DoNotOptimize(model.at(input));
  }
}

void drag(benchmark::State& state) {
  const auto space_weather = std::make_shared<const truth::SpaceWeather>(
      truth::SpaceWeather::load(kData / "earth/space_weather_2009_2013.csv"));
  const truth::SurfaceProperties spacecraft{.mass_kg = 180.0, .drag_area_m2 = 0.7, .drag_coefficient = 2.3};
  truth::DragForce force(spacecraft, tables(), space_weather, GeomagneticIndex::kDaily,
                         truth::gps_from_utc("2011-07-18T01:00:00Z"));
  truth::ForceInput input;
  input.velocity_eci << 0.0, 0.0, 7500.0;
  double angle = 0.0;
  for (auto _ : state) {
    angle += 0.02;
    input.seconds = input.seconds < 80000.0 ? input.seconds + 20.0 : 0.0;
    input.position_eci << 6878e3 * std::cos(angle), 0.0, 6878e3 * std::sin(angle);
    input.position_itrf = input.position_eci;
    benchmark::DoNotOptimize(force.acceleration_eci(input));
  }
}

BENCHMARK_CAPTURE(nrlmsise00, 120km, 120.0, GeomagneticIndex::kDaily)->Name("nrlmsise00/vbar/120km");
BENCHMARK_CAPTURE(nrlmsise00, 400km, 400.0, GeomagneticIndex::kDaily)->Name("nrlmsise00/vbar/400km");
BENCHMARK_CAPTURE(nrlmsise00, 800km, 800.0, GeomagneticIndex::kDaily)->Name("nrlmsise00/vbar/800km");
BENCHMARK_CAPTURE(nrlmsise00, 400km_3h, 400.0, GeomagneticIndex::kThreeHourly)
    ->Name("nrlmsise00/vbar_three_hourly/400km");
BENCHMARK(nrlmsise00_new_day)->Name("nrlmsise00/vbar_new_day/400km");
BENCHMARK(drag)->Name("drag/vbar/500km");

}  // namespace
