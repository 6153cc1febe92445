// What the model's air must obey, whatever its coefficients: hydrostatic and diffusive equilibrium, and the world's
// mean against a standard atmosphere.

#include <cmath>

#include <gtest/gtest.h>

#include "host_sim/truth/atmosphere/nrlmsise00.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/atmosphere/reference_cases.h"

namespace vbar::truth {
namespace {

constexpr double kGasConstant = 8.314;  // J/(mol K), as the model rounds it

AtmosphereInput somewhere(double altitude_km) {
  AtmosphereInput input = test::input_of(test::reference_rows("full_precision_cases.csv").front());
  input.altitude_km = altitude_km;
  return input;
}

/// Gravity at latitude 60 deg by the normal formula of GRS 80 and inverse squares; the model's own formula (Lambert's)
/// differs from it by up to 1e-3.
double gravity(double altitude_km) {
  const double s2 = 0.75;  // sin^2(60 deg)
  const double at_surface = 9.7803267715 * (1.0 + 0.0052790414 * s2 + 0.0000232718 * s2 * s2);
  const double ratio = 1.0 + altitude_km / 6363.0;  // the radius at latitude 60 deg
  return at_surface / (ratio * ratio);
}

TEST(Nrlmsise00Physics, MixedAirIsInHydrostaticEquilibrium) {
  // Below 62.5 km: d ln(n T)/dz = -M g / (R T), with the mean molar mass that the model says, 28.95 g/mol.
  Nrlmsise00 model(test::published_tables());
  const auto log_pressure = [&](double altitude_km) {
    const AtmosphereState air = model.at(somewhere(altitude_km));
    return std::log(air.per_m3.n2 * air.temperature);
  };
  for (const double altitude_km : {1.0, 5.0, 12.0, 18.0, 25.0, 40.0, 50.0, 60.0}) {
    constexpr double kStepKm = 0.01;  // truncation 1e-7 of the slope, rounding 1e-9
    const double slope_per_km =
        (log_pressure(altitude_km + kStepKm) - log_pressure(altitude_km - kStepKm)) / (2.0 * kStepKm);
    const double temperature = model.at(somewhere(altitude_km)).temperature;
    const double expected_per_km = -28.95 * gravity(altitude_km) / (kGasConstant * temperature);
    EXPECT_NEAR(slope_per_km / expected_per_km, 1.0, 2e-3) << altitude_km;  // the gravity formulas' difference
  }
}

TEST(Nrlmsise00Physics, HighSpeciesAreInDiffusiveEquilibrium) {
  // Above 450 km each species has its own scale height: d ln n/dz = -M g / (R T) - (1 + alpha) d ln T/dz, T constant.
  Nrlmsise00 model(test::published_tables());
  for (const double altitude_km : {600.0, 800.0, 1000.0}) {
    constexpr double kStepKm = 0.1;
    const AtmosphereState above = model.at(somewhere(altitude_km + kStepKm));
    const AtmosphereState below = model.at(somewhere(altitude_km - kStepKm));
    const double temperature = model.at(somewhere(altitude_km)).temperature;
    const auto expect_scale_height = [&](double molar_mass, double n_above, double n_below) {
      const double slope_per_km = std::log(n_above / n_below) / (2.0 * kStepKm);
      const double expected_per_km = -molar_mass * gravity(altitude_km) / (kGasConstant * temperature);
      // The gravity formulas' difference, and what is left of the temperature gradient (below 0.02 K/km of 1240 K).
      EXPECT_NEAR(slope_per_km / expected_per_km, 1.0, 3e-3) << altitude_km << " km, M " << molar_mass;
    };
    expect_scale_height(16.0, above.per_m3.o, below.per_m3.o);
    expect_scale_height(28.0, above.per_m3.n2, below.per_m3.n2);
    expect_scale_height(32.0, above.per_m3.o2, below.per_m3.o2);
    expect_scale_height(4.0, above.per_m3.he, below.per_m3.he);
    expect_scale_height(14.0, above.per_m3.n, below.per_m3.n);
  }
}

/// Means over day, season and globe. That of density is of its logarithm, which goes with temperature.
struct GlobalMean {
  double density, exospheric_temperature;
};

GlobalMean global_mean(double altitude_km, double f107) {
  Nrlmsise00 model(test::published_tables());
  double log_density = 0.0, temperature = 0.0, weights = 0.0;
  for (int day = 15; day < 366; day += 61) {
    for (int latitude_deg = -75; latitude_deg <= 75; latitude_deg += 30) {
      for (int longitude_deg = -180; longitude_deg < 180; longitude_deg += 60) {
        for (int hour = 0; hour < 24; hour += 4) {
          AtmosphereInput input;
          input.day_of_year = day;
          input.altitude_km = altitude_km;
          input.latitude_deg = latitude_deg;
          input.longitude_deg = longitude_deg;
          input.ut_s = 3600.0 * hour;
          input.local_solar_time_h = hour + longitude_deg / 15.0;
          input.indices.f107 = input.indices.f107_average = f107;
          input.indices.ap_daily = 10.0;
          const AtmosphereState air = model.at(input);
          const double weight = std::cos(latitude_deg * M_PI / 180.0);
          log_density += weight * std::log(air.drag_density);
          temperature += weight * air.exospheric_temperature;
          weights += weight;
        }
      }
    }
  }
  return {std::exp(log_density / weights), temperature / weights};
}

/// The solar flux whose mean exosphere has the standard atmosphere's 1000 K.
double standard_flux() {
  double low = 70.0, high = 250.0;
  while (high - low > 0.1) {
    const double middle = 0.5 * (low + high);
    (global_mean(400.0, middle).exospheric_temperature < 1000.0 ? low : high) = middle;
  }
  return low;
}

TEST(Nrlmsise00Physics, WorldMeanIsNearTheStandardAtmosphere) {
  // U.S. Standard Atmosphere 1976, tables I and VIII (an exosphere of 1000 K). Near the ground the two agree as the air
  // of 45 deg north, which the standard is, with the world's. The thermosphere of 1976 and that of 2002 differ by 10 to
  // 20 % where data changed the model (Picone et al. 2002).
  const double f107 = standard_flux();
  EXPECT_NEAR(global_mean(0.0, f107).density / 1.2250, 1.0, 0.03);
  EXPECT_NEAR(global_mean(10.0, f107).density / 0.41351, 1.0, 0.03);
  EXPECT_NEAR(global_mean(30.0, f107).density / 0.018410, 1.0, 0.03);
  EXPECT_NEAR(global_mean(120.0, f107).density / 2.222e-8, 1.0, 0.2);
  EXPECT_NEAR(global_mean(200.0, f107).density / 2.541e-10, 1.0, 0.2);
  EXPECT_NEAR(global_mean(400.0, f107).density / 2.803e-12, 1.0, 0.2);
  EXPECT_NEAR(global_mean(600.0, f107).density / 1.137e-13, 1.0, 0.2);
}

}  // namespace
}  // namespace vbar::truth
