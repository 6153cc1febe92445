// Prints navigation errors at the waypoints for seeds 1 to N: what the report and the tests look at.

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tests/integration/angles_only/true_flight.h"
#include "tests/support/figures.h"

int main(int argc, char** argv) {
  using namespace vbar;
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
    fsw::filter::FilterSettings blocks;
    blocks.earth = flight.earth;
    blocks.relative_orbit.acceleration.psd = option("PSD", blocks.relative_orbit.acceleration.psd);
    blocks.processes.of<fsw::measurements::BearingBias>().sigma = option("BIAS_SIGMA", 3.0) / 206264.8;
    blocks.burn_sigma_relative = option("MAN", blocks.burn_sigma_relative);
    blocks.processes.of<fsw::measurements::CentroidWander>() = {.sigma = option("WANDER", 0.035),
                                                                .time_s = option("WANDER_TIME", 300.0)};
    blocks.absolute_orbit.slow_error_sigma_m = option("OWN_SIGMA", blocks.absolute_orbit.slow_error_sigma_m);
    blocks.absolute_orbit.acceleration_psd = option("OWN_PSD", blocks.absolute_orbit.acceleration_psd);
    fsw::measurements::BearingSettings bearings;
    bearings.model.centroid_noise_m = option("CENTROID", 0.0);
    test::AnglesOnlyFlight navigation(blocks, bearings, sensors.apriori());
    std::size_t waypoint = 0;
    double nis = 0.0;
    double own = 0.0;
    int updates = 0;
    std::printf("%3u", seed);
    for (std::size_t k = 0; k < flight.epochs.size(); ++k) {
      if (navigation.update(sensors.measure(k), sensors.known_burns()) ==
          fsw::measurements::BearingEditStatus::kFilter) {
        nis += navigation.bearings().last_update().nis;
        ++updates;
      }
      if (k % 10 == 0 && k > 60) own += test::own_orbit_nees(flight.epochs[k], navigation.filter()) / 210.0;
      if (waypoint < 7 && k == test::TrueFlight::at_hours(kHours[waypoint])) {
        const fsw::Vector3 error =
            test::estimated_position_rtn(navigation.filter()) - test::true_position_rtn(flight.epochs[k]);
        const fsw::Matrix6 covariance =
            fsw::filter::covariance_rtn(navigation.filter().estimate(), navigation.filter().servicer());
        const double sigma = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
        std::printf(" | %8.2f (%7.2f) %4.1f", error.norm(), sigma,
                    test::roe_nees(flight.epochs[k], navigation.filter()));
        nees[waypoint] += test::roe_nees(flight.epochs[k], navigation.filter()) / seeds;
        errors[waypoint].push_back(error.norm());
        ++waypoint;
      }
    }
    const auto& counters = navigation.bearings().counters();
    std::printf(" | psd %.0e nis %.3f own orbit %.2f used %d refused %d failed %d inflated %d restarts %d\n",
                navigation.filter().relative_orbit().noise().psd(), nis / updates, own, counters.used,
                counters.rejected, counters.batches_failed, counters.revisions, counters.restarts);
  }
  std::printf("med");
  for (const auto& of : errors) std::printf(" | %8.2f          ", vbar::accuracy::median(of));
  std::printf("\nnees");
  for (const double mean : nees) std::printf(" | %8.2f          ", mean);
  std::printf("\n");
}
