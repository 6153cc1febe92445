// The atmosphere's cost: NRLMSISE-00 at places and times that change from call to call, as on an orbit, on one day;
// with daily and three-hourly indices; on the first call of a new day; and a whole drag acceleration.

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <erfa.h>

#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "host_sim/truth/attitude/torques.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/truth/forces/solid_tides.h"
#include "host_sim/truth/orbital_motion.h"
#include "host_sim/truth/spacecraft_propagator.h"
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

// One orbit of attitude: torque-free, and under gravity gradient on a circular orbit.

namespace {

using vbar::fsw::Matrix3;
using vbar::fsw::Vector3;

constexpr double kGm = 3.986004415e14;
constexpr double kRadius = 7078e3;
constexpr double kOrbit_s = 5926.0;
constexpr double kTolerance = 1e-12;  // a mission's usual one
const Matrix3 kInertia = Vector3(2.685703125, 3.458072723298021, 3.106463735035312).asDiagonal();
const truth::AttitudeState kOneDegreeASecond{Eigen::Quaterniond::Identity(), {0.010, -0.010, 0.010}};

truth::ForceInput circular_orbit(double t) {
  const double n = std::sqrt(kGm / (kRadius * kRadius * kRadius));
  truth::ForceInput input;
  input.seconds = t;
  input.position_eci = kRadius * Vector3(std::cos(n * t), std::sin(n * t), 0.0);
  return input;
}

void one_orbit(benchmark::State& state, bool with_torque) {
  std::int64_t steps = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<truth::Torque>> torques;
    if (with_torque) torques.push_back(std::make_unique<truth::GravityGradientTorque>(kGm, kInertia));
    truth::RigidBody body(kInertia, std::move(torques), circular_orbit, kTolerance, 0.0, kOneDegreeASecond);
    body.advance_to(kOrbit_s);
    benchmark::DoNotOptimize(body.state_at(kOrbit_s));
    steps = body.statistics().accepted_steps;
  }
  state.counters["steps"] = static_cast<double>(steps);
}

BENCHMARK_CAPTURE(one_orbit, torque_free, false)->Name("attitude/vbar/one_orbit_tumble")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_orbit, gravity_gradient, true)
    ->Name("attitude/vbar/one_orbit_gravity_gradient")
    ->Unit(benchmark::kMillisecond);

}  // namespace

// Sun and Moon: where they are, what they pull, and what locating the shadow's edges adds to a day of flight.

namespace {

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

// The cost of the small forces: tides, relativity.

namespace {

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
