// Sun and Moon: where they are, what they pull, and what locating the shadow's edges adds to a day of flight.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <erfa.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/gravity_force.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/forces/third_body_force.h"
#include "host_sim/truth/orbit_geometry.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/support/paths.h"

namespace {

using vbar::fsw::Vector3;
namespace truth = vbar::truth;

const std::string kDataFolder = vbar::tests::source_path("data");
constexpr double kDay = 2455760.5;
constexpr double kMinute = 1.0 / 1440.0;

void sun_moon_interpolated(benchmark::State& state) {
  truth::SunMoonInterpolator interpolator;
  double minutes = 0.0;  // a minute a call, so that the nodes' cost is in
  for (auto _ : state) {
    benchmark::DoNotOptimize(interpolator.at({kDay, minutes * kMinute}));
    minutes = minutes < 1e6 ? minutes + 1.0 : 0.0;
  }
}
BENCHMARK(sun_moon_interpolated)->Name("sun_moon/vbar/interpolated");

void sun_moon_direct(benchmark::State& state) {
  double heliocentric[2][3], barycentric[2][3], moon[2][3], minutes = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(eraEpv00(kDay, minutes * kMinute, heliocentric, barycentric));
    eraMoon98(kDay, minutes * kMinute, moon);
    benchmark::DoNotOptimize(moon);
    minutes = minutes < 1e6 ? minutes + 1.0 : 0.0;
  }
}
BENCHMARK(sun_moon_direct)->Name("sun_moon/erfa/direct");

void third_body(benchmark::State& state) {
  truth::ThirdBodyForce sun(truth::ThirdBodyForce::Body::kSun), moon(truth::ThirdBodyForce::Body::kMoon);
  const truth::SunMoon positions = truth::sun_moon_series({kDay, 0.3});
  truth::ForceInput input;
  input.position_eci = Vector3(4.0e6, -3.0e6, 5.0e6);
  input.sun_eci = positions.sun_eci;
  input.moon_eci = positions.moon_eci;
  for (auto _ : state) {
    benchmark::DoNotOptimize(input);
    benchmark::DoNotOptimize(Vector3(sun.acceleration_eci(input) + moon.acceleration_eci(input)));
  }
}
BENCHMARK(third_body)->Name("third_body/vbar/both");

/// A day of the mission's orbit, turned off the terminator so that every orbit is eclipsed: gravity 60x60, Sun, Moon,
/// radiation pressure; tolerance 1e-12.
void day_in_sunlight(benchmark::State& state, truth::Shadow shadow) {
  constexpr double kDegree = M_PI / 180.0;
  const auto model = truth::load_gravity_coefficients(kDataFolder + "/gravity/ggm05s_120.txt", 60);
  const auto gravity = std::make_shared<const truth::GravityField>(model, 60, 60);
  const auto orientation = std::make_shared<const truth::EarthOrientationSeries>(
      truth::EarthOrientationSeries::load(kDataFolder + "/earth/eop_2009_2013.csv"));
  truth::SurfaceProperties surface;
  surface.mass_kg = 154.0;
  surface.radiation_area_m2 = 2.5;
  surface.radiation_coefficient = 1.32;
  const auto start =
      truth::orbit_geometry({7087300.0, 0.0015, 0.0, 98.18 * kDegree, -30.0 * kDegree, -0.69 * kDegree}, gravity->gm());
  std::int64_t steps = 0, edges = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<truth::Force>> forces;
    forces.push_back(std::make_unique<truth::GravityForce>(gravity));
    forces.push_back(std::make_unique<truth::ThirdBodyForce>(truth::ThirdBodyForce::Body::kSun));
    forces.push_back(std::make_unique<truth::ThirdBodyForce>(truth::ThirdBodyForce::Body::kMoon));
    forces.push_back(std::make_unique<truth::RadiationPressureForce>(surface, shadow));
    truth::SpacecraftPropagator propagator(
        std::make_unique<truth::SpacecraftDynamics>(
            "bench", gravity->gm(), gravity->radius(),
            truth::EarthRotation(orientation, truth::gps_from_utc("2011-07-18T01:00:00Z")), std::move(forces)),
        1e-12, 0.0, start.state);
    propagator.advance_to(86400.0);
    steps = propagator.statistics().accepted_steps;
    edges = propagator.edges_crossed();
  }
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["edges"] = static_cast<double>(edges);
}
BENCHMARK_CAPTURE(day_in_sunlight, none, truth::Shadow::kNone)
    ->Name("day_in_sunlight/vbar/none")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(day_in_sunlight, cylindrical, truth::Shadow::kCylindrical)
    ->Name("day_in_sunlight/vbar/cylindrical")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(day_in_sunlight, conical, truth::Shadow::kConical)
    ->Name("day_in_sunlight/vbar/conical")
    ->Unit(benchmark::kMillisecond);

}  // namespace
