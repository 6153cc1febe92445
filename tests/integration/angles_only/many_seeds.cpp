// Prints navigation errors at the waypoints for seeds 1 to N: what the report and the tests look at.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "tests/integration/angles_only/observability_bound.h"
#include "tests/integration/angles_only/true_flight.h"
#include "tests/support/figures.h"

int main(int argc, char** argv) {
  using namespace vbar;
  namespace nav = fsw::navigation;
  const unsigned seeds = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 10;
  const auto option = [&](const char* name, double otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr ? std::atof(text) : otherwise;
  };
  const test::TrueFlight flight = test::fly_truly(36.0);
  constexpr double kHours[] = {6.0, 12.0, 18.0, 24.0, 28.0, 32.0, 36.0};
  std::vector<std::vector<double>> errors(7);
  std::vector<double> nees(7, 0.0);
  std::vector<std::size_t> at;
  for (const double hours : kHours) at.push_back(test::TrueFlight::at_hours(hours));
  std::printf("bnd");
  for (const double bound : test::position_bound(flight, at)) std::printf(" | %8.2f          ", bound);
  std::printf("\n");
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    test::SensorErrors sensor_errors;
    sensor_errors.bias_arcsec = option("BIAS", sensor_errors.bias_arcsec);
    sensor_errors.bearing_arcsec = option("NOISE", sensor_errors.bearing_arcsec);
    sensor_errors.shape_share = option("SHAPE", sensor_errors.shape_share);
    sensor_errors.gnss_slow_m = option("GNSS_SLOW", sensor_errors.gnss_slow_m);
    sensor_errors.burn_relative = option("BURN", 0.0);
    sensor_errors.outlier_share = option("OUTLIERS", 0.0);
    sensor_errors.gnss_white_m = option("GNSS_WHITE", sensor_errors.gnss_white_m);
    test::SimulatedSensors sensors(flight, sensor_errors, seed);
    nav::AnglesOnlySettings settings;
    settings.earth = flight.earth;
    settings.filter.brightness_offset_m = 0.1;
    settings.filter.acceleration.psd = option("PSD", settings.filter.acceleration.psd);
    settings.filter.bearing_bias_sigma = option("BIAS_SIGMA", 3.0) / 206264.8;
    settings.filter.maneuver_sigma_relative = option("MAN", settings.filter.maneuver_sigma_relative);
    settings.filter.resolved_share = option("RESOLVED", settings.filter.resolved_share);
    settings.own_orbit.position_sigma_m = option("OWN_SIGMA", settings.own_orbit.position_sigma_m);
    settings.own_orbit.acceleration_psd = option("OWN_PSD", settings.own_orbit.acceleration_psd);
    auto navigation = std::make_unique<nav::AnglesOnlyNavigation>(settings);
    navigation->set_apriori(sensors.apriori());
    std::size_t waypoint = 0;
    double nis = 0.0;
    int updates = 0;
    std::printf("%3u", seed);
    for (std::size_t k = 0; k < flight.epochs.size(); ++k) {
      navigation->update(sensors.measure(k), sensors.known_burns());
      if (navigation->last_update().accepted) {
        nis += navigation->last_update().nis;
        ++updates;
      }
      if (waypoint < 7 && k == test::TrueFlight::at_hours(kHours[waypoint])) {
        const fsw::Vector3 error =
            test::estimated_position_rtn(*navigation) - test::true_position_rtn(flight.epochs[k]);
        const fsw::Matrix6 covariance = navigation->covariance_rtn();
        const double sigma = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
        std::printf(" | %8.2f (%7.2f) %4.1f", error.norm(), sigma, test::roe_nees(flight.epochs[k], *navigation));
        nees[waypoint] += test::roe_nees(flight.epochs[k], *navigation) / seeds;
        errors[waypoint].push_back(error.norm());
        ++waypoint;
      }
    }
    const auto& counters = navigation->counters();
    std::printf(" | psd %.0e nis %.3f used %d refused %d failed %d doubts %d restarts %d\n",
                navigation->filter().acceleration_psd(), nis / updates, counters.bearings_used,
                counters.bearings_refused, counters.batches_failed, counters.inflations, counters.restarts);
  }
  std::printf("med");
  for (const auto& of : errors) std::printf(" | %8.2f          ", vbar::accuracy::median(of));
  std::printf("\nnees");
  for (const double mean : nees) std::printf(" | %8.2f          ", mean);
  std::printf("\n");
}
