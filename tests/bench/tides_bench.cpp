// The cost of the small forces: tides, relativity.

#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/relativity_force.h"
#include "host_sim/truth/forces/solid_tides_force.h"
#include "tests/support/paths.h"

namespace {

namespace truth = vbar::truth;

constexpr double kTideGm = 3.986004415e14, kTideRadius = 6378136.3;

/// A force asked along an orbit as an integrator does, some seconds apart.
void along_an_orbit(benchmark::State& state, truth::Force& force) {
  const auto epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  truth::ForceInput input;
  input.position_eci << 4.0e6, -3.0e6, 5.0e6;
  input.velocity_eci << 5.0e3, 5.6e3, 0.0;
  const truth::SunMoon bodies = truth::sun_moon_series(truth::tt_of(epoch));
  input.sun_eci = bodies.sun_eci;
  input.moon_eci = bodies.moon_eci;
  input.position_itrf = input.position_eci;
  for (auto _ : state) {
    input.seconds = input.seconds < 18000.0 ? input.seconds + 7.0 : 0.0;
    benchmark::DoNotOptimize(force.acceleration_eci(input));
  }
}

void solid_tides(benchmark::State& state) {
  truth::SolidTidesForce force(
      kTideGm, kTideRadius, truth::TideSystem::kZeroTide, truth::gps_from_utc("2011-07-18T01:00:00Z"),
      std::make_shared<const truth::EarthOrientationSeries>(
          truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv"))));
  along_an_orbit(state, force);
}

void relativity(benchmark::State& state) {
  truth::RelativityForce force(kTideGm);
  along_an_orbit(state, force);
}

BENCHMARK(solid_tides)->Name("solid_tides/vbar/1");
BENCHMARK(relativity)->Name("relativity/vbar/1");

}  // namespace
