// The truth model's cost: gravity beside GeographicLib's SphericalHarmonic, the frame chain, and whole orbits.

#include <cstdint>
#include <string>
#include <vector>

#include <GeographicLib/SphericalHarmonic.hpp>
#include <benchmark/benchmark.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/truth_model.h"
#include "tests/support/paths.h"

namespace {

using vbar::fsw::Vector3;
namespace truth = vbar::truth;

const std::string kData = vbar::tests::source_path("data");
const Vector3 kLowOrbit(4.0e6, -3.0e6, 5.0e6);

truth::GravityCoefficients coefficients(int degree) {
  return truth::load_gravity_coefficients(kData + "/gravity/ggm05s_120.txt", degree);
}

void gravity(benchmark::State& state, int degree) {
  const truth::GravityField field(coefficients(degree), degree, degree);
  Vector3 position = kLowOrbit;
  for (auto _ : state) {
    benchmark::DoNotOptimize(position);
    benchmark::DoNotOptimize(field.perturbation_itrf(position));
  }
}

void gravity_portable(benchmark::State& state, int degree) {
  const truth::GravityField field(coefficients(degree), degree, degree, truth::sum_harmonics_portable);
  Vector3 position = kLowOrbit;
  for (auto _ : state) {
    benchmark::DoNotOptimize(position);
    benchmark::DoNotOptimize(field.perturbation_itrf(position));
  }
}

void gravity_geographiclib(benchmark::State& state, int degree) {
  const truth::GravityCoefficients model = coefficients(degree);
  std::vector<double> c, s;  // order by order, sine terms from order 1
  for (int m = 0; m <= degree; ++m) {
    for (int n = m; n <= degree; ++n) {
      c.push_back(model.c_nm(n, m));
      if (m > 0) s.push_back(model.s_nm(n, m));
    }
  }
  const GeographicLib::SphericalHarmonic harmonic(c, s, degree, model.radius);
  Vector3 position = kLowOrbit, gradient;
  for (auto _ : state) {
    benchmark::DoNotOptimize(position);
    benchmark::DoNotOptimize(
        harmonic(position.x(), position.y(), position.z(), gradient.x(), gradient.y(), gradient.z()));
    benchmark::DoNotOptimize(gradient);
  }
}

void earth_rotation(benchmark::State& state) {
  const auto orientation = std::make_shared<const truth::EarthOrientationSeries>(
      truth::EarthOrientationSeries::load(kData + "/earth/eop_2009_2013.csv"));
  truth::EarthRotation rotation(orientation, truth::gps_from_utc("2011-07-18T01:00:00Z"));
  double seconds = 0.0;
  for (auto _ : state) {
    seconds = seconds < 18000.0 ? seconds + 7.0 : 0.0;
    benchmark::DoNotOptimize(rotation.R_itrf_gcrf_at(seconds));
  }
}

vbar::fsw::orbit::CartesianState servicer_state() {
  vbar::fsw::orbit::CartesianState servicer;
  servicer.position_eci << 12161.8456633, -7076153.584868, -84606.5539942;
  servicer.velocity_eci << -1068.5690877908, -90.5830005301, 7433.7358593127;
  return servicer;
}

truth::TruthSettings gravity_settings() {
  truth::TruthSettings settings;
  settings.epoch = truth::gps_from_utc("2011-07-18T01:00:00Z");
  settings.tolerance = 1e-13;
  settings.data_directory = kData;
  return settings;
}

/// Two spacecraft 10 m apart for one orbit, asked for every 10 s.
void one_orbit_two_spacecraft(benchmark::State& state) {
  const truth::TruthSettings settings = gravity_settings();
  const vbar::fsw::orbit::CartesianState servicer = servicer_state();
  vbar::fsw::orbit::CartesianState target = servicer;
  target.position_eci.y() += 10.0;
  std::int64_t evaluations = 0;
  for (auto _ : state) {
    state.PauseTiming();
    truth::TruthModel model(settings);
    model.add_spacecraft("servicer", servicer);
    model.add_spacecraft("target", target);
    const std::int64_t before = model.statistics().force_evaluations;
    state.ResumeTiming();
    for (int second = 10; second <= 5930; second += 10) {
      model.advance_to(settings.epoch + vbar::fsw::duration_of_seconds(second));
      benchmark::DoNotOptimize(model.state(0));
      benchmark::DoNotOptimize(model.state(1));
    }
    evaluations = model.statistics().force_evaluations - before;
  }
  state.counters["force_evaluations"] = static_cast<double>(evaluations);
}

/// What a flight under drag, radiation pressure, Sun and Moon costs; the error after a day at this tolerance is below a
/// metre (tests/unit/host_sim/truth/truth_model_test.cpp).
struct Flight {
  int degree = 60;
  int spacecraft = 1;
  int days = 1;
  bool forces = true;
  int threads = 1;
};

truth::TruthModel make_model(const Flight& flight) {
  truth::TruthSettings settings = gravity_settings();
  settings.tolerance = 1e-11;
  settings.gravity_degree = settings.gravity_order = flight.degree;
  settings.forces.drag = settings.forces.radiation_pressure = settings.forces.sun = settings.forces.moon =
      flight.forces;
  settings.threads = flight.threads;
  truth::TruthModel model(settings);
  for (int k = 0; k < flight.spacecraft; ++k) {
    // Seven metres apart along the track: each its own integration of about the same length.
    vbar::fsw::orbit::CartesianState state = servicer_state();
    state.position_eci += 1e-3 * k * state.velocity_eci;
    model.add_spacecraft({"s" + std::to_string(k), state, {154.0, 1.3, 2.5, 2.5, 1.32}});
  }
  return model;
}

void fly(benchmark::State& state, const Flight& flight) {
  std::int64_t evaluations = 0;
  for (auto _ : state) {
    state.PauseTiming();
    truth::TruthModel model = make_model(flight);
    state.ResumeTiming();
    model.advance_to(model.time() + vbar::fsw::duration_of_seconds(86400 * flight.days));
    benchmark::DoNotOptimize(model.state(0));
    evaluations = model.statistics().force_evaluations;
  }
  state.counters["force_evaluations"] = static_cast<double>(evaluations);
}

/// The day again, with the time of each force taken: counters in milliseconds of it.
void force_shares(benchmark::State& state) {
  std::vector<truth::ForceTime> times;
  for (auto _ : state) {
    state.PauseTiming();
    truth::TruthModel model = make_model({});
    model.measure_force_times(true);
    state.ResumeTiming();
    model.advance_to(model.time() + vbar::fsw::duration_of_seconds(86400));
    times = model.force_times();
  }
  for (const truth::ForceTime& time : times) state.counters[std::string(time.force) + "_ms"] = 1e3 * time.wall_s;
}

BENCHMARK_CAPTURE(gravity, 60, 60)->Name("gravity/vbar/60");
BENCHMARK_CAPTURE(gravity, 120, 120)->Name("gravity/vbar/120");
BENCHMARK_CAPTURE(gravity_portable, 60, 60)->Name("gravity/vbar_portable/60");
BENCHMARK_CAPTURE(gravity_geographiclib, 60, 60)->Name("gravity/geographiclib/60");
BENCHMARK_CAPTURE(gravity_geographiclib, 120, 120)->Name("gravity/geographiclib/120");
BENCHMARK(earth_rotation)->Name("earth_rotation/vbar/1");
BENCHMARK(one_orbit_two_spacecraft)->Name("truth/vbar/one_orbit_two_spacecraft")->Unit(benchmark::kMillisecond);

void name_flight(const std::string& name, const Flight& flight) {
  benchmark::RegisterBenchmark(("truth/vbar/" + name).c_str(), fly, flight)->Unit(benchmark::kMillisecond);
}

/// Cost against degree, number of spacecraft, days and threads; the names carry the number that varies.
[[maybe_unused]] const bool kNamed = [] {
  name_flight("one_day_full", {});
  name_flight("one_day_gravity", {.forces = false});
  for (int degree : {20, 40, 60, 80, 100, 120}) name_flight("degree_" + std::to_string(degree), {.degree = degree});
  for (int count : {1, 2, 10, 50}) name_flight("spacecraft_" + std::to_string(count), {.spacecraft = count});
  for (int days : {1, 2, 5}) name_flight("days_" + std::to_string(days), {.days = days});
  for (int threads : {1, 2, 4, 8})
    name_flight("threads_" + std::to_string(threads), {.spacecraft = 16, .threads = threads});
  return true;
}();
BENCHMARK(force_shares)->Name("truth/vbar/force_shares")->Unit(benchmark::kMillisecond);

}  // namespace
