// The angles-only rendezvous without images: bearings as image processing promises them, burns as flown before, all
// forces in the truth. Errors of navigation at the waypoints, and their consistency with its covariance.

#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/integration/angles_only/true_flight.h"
#include "tests/support/accuracy.h"

namespace vbar::test {
namespace {

constexpr double kWaypointHours[] = {6.0, 12.0, 18.0, 24.0, 28.0, 32.0, 36.0};

fsw::filter::FilterSettings blocks_for(const TrueFlight& flight, const SensorErrors& errors) {
  fsw::filter::FilterSettings settings;
  settings.earth = flight.earth;
  settings.processes.of<fsw::measurements::CentroidWander>() = {.sigma = errors.shape_share * kTargetRadius_m,
                                                                .time_s = errors.shape_time_s};
  return settings;
}

/// The simulated centroid wanders, and has no noise in addition.
fsw::measurements::BearingSettings bearings_for() {
  fsw::measurements::BearingSettings settings;
  settings.model.centroid_noise_m = 0.0;
  settings.batch.bearings = 40;
  return settings;
}

struct AtWaypoint {
  double error_m = 0.0;
  double nees = 0.0;
};

/// What came of a flight of one seed, and its navigation at the end.
struct Outcome {
  std::vector<AtWaypoint> waypoints;
  double far_nis = 0.0;         ///< mean, of bearings to a point
  double own_orbit_nees = 0.0;  ///< mean, of an image in ten minutes after the first hour
  fsw::measurements::BearingCounters counters;
};

Outcome navigate(const TrueFlight& flight, const SensorErrors& errors, unsigned seed) {
  SimulatedSensors sensors(flight, errors, seed);
  AnglesOnlyFlight navigation(blocks_for(flight, errors), bearings_for(), sensors.apriori());
  Outcome outcome;
  int far = 0;
  int own_orbits = 0;
  for (std::size_t k = 0; k < flight.epochs.size(); ++k) {
    const MeasuredEpoch epoch = sensors.measure(k);
    const auto status = navigation.update(epoch, sensors.known_burns());
    const bool is_point = epoch.bearing && epoch.bearing->apparent_radius < 0.5 * epoch.bearing->sigma;
    if (status == fsw::measurements::BearingEditStatus::kFilter && is_point) {
      outcome.far_nis += navigation.bearings().last_update().nis;
      ++far;
    }
    if (k > 60 && k % 10 == 0) {
      outcome.own_orbit_nees += own_orbit_nees(flight.epochs[k], navigation.filter());
      ++own_orbits;
    }
    const std::size_t next = outcome.waypoints.size();
    if (next < 7 && k == TrueFlight::at_hours(kWaypointHours[next]) && navigation.valid()) {
      const fsw::Vector3 error = estimated_position_rtn(navigation.filter()) - true_position_rtn(flight.epochs[k]);
      outcome.waypoints.push_back({error.norm(), roe_nees(flight.epochs[k], navigation.filter())});
    }
  }
  outcome.far_nis /= std::max(far, 1);
  outcome.own_orbit_nees /= std::max(own_orbits, 1);
  outcome.counters = navigation.bearings().counters();
  return outcome;
}

/// Truth once for all tests: it is the same for every seed.
const TrueFlight& whole_flight() {
  static const TrueFlight flight = fly_truly(36.0);
  return flight;
}

TEST(AnglesOnly, KnowsTheTargetAtTheWaypoints) {
  constexpr unsigned kSeeds = 4;
  // Errors of bearings as promised; burns known to a thousandth, as the filter is configured.
  SensorErrors errors;
  errors.burn_relative = 1e-3;
  std::vector<std::vector<double>> error(7);
  std::vector<double> nees(7, 0.0);
  double nis = 0.0;
  double own_orbit_nees = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Outcome outcome = navigate(whole_flight(), errors, seed);
    ASSERT_EQ(outcome.waypoints.size(), 7u);
    for (std::size_t w = 0; w < 7; ++w) {
      error[w].push_back(outcome.waypoints[w].error_m);
      nees[w] += outcome.waypoints[w].nees / kSeeds;
    }
    nis += outcome.far_nis / kSeeds;
    own_orbit_nees += outcome.own_orbit_nees / kSeeds;
    EXPECT_EQ(outcome.counters.restarts, 0);
    EXPECT_EQ(outcome.counters.batches_failed, 0);
    // One in a thousand by the gate, of some 1800.
    EXPECT_LE(outcome.counters.rejected, 10);
  }
  // What the mission asks for, at waypoints 1 to 7.
  constexpr double kAsked[] = {40.0, 20.0, 3.0, 1.0, 1.5, 0.7, 1.0};
  std::vector<std::size_t> epochs;
  for (const double hours : kWaypointHours) epochs.push_back(TrueFlight::at_hours(hours));
  const std::vector<double> bound = position_bound(whole_flight(), epochs);
  std::vector<std::vector<std::string>> table = {
      {"waypoint", "median error, m", "Cramer-Rao bound, m", "mean NEES (6)"}};
  for (std::size_t w = 0; w < 7; ++w) {
    const std::string name = std::to_string(w + 1);
    accuracy::expect_below("angles-only navigation at waypoint " + name,
                           "truth, all forces, simulated bearings, 4 seeds", accuracy::median(error[w]), kAsked[w],
                           "m");
    // Chi-square of 24 degrees of freedom: 99.9 % below 51. Far below six would be a filter that does not trust itself.
    EXPECT_LT(nees[w], 51.2 / kSeeds) << name;
    EXPECT_GT(nees[w], 1.0) << name;
    table.push_back({name, accuracy::detail::number_text(accuracy::median(error[w])),
                     accuracy::detail::number_text(bound[w]), accuracy::detail::number_text(nees[w])});
  }
  accuracy::record_table("Angles-only navigation without images", table);
  // Errors of half an hour's correlation: 4 x 35 h are some 140 independent ones of six degrees of freedom.
  accuracy::expect_below("NEES of the servicer's own orbit (6)", "truth, all forces, simulated positions, 4 seeds",
                         own_orbit_nees, 7.8, "");
  EXPECT_GT(own_orbit_nees, 4.5);
  // Of some 4 x 1000 bearings with two degrees of freedom: 2 within 0.1, and what the bias's uncertainty adds.
  EXPECT_NEAR(nis, 2.0, 0.25);
}

TEST(AnglesOnly, NoErrorIsFarBelowTheBoundSoTheBoundIsOne) {
  // The bound must fall with time and with every burn; here against a filter given the true burns.
  const std::vector<std::size_t> epochs = {TrueFlight::at_hours(1.0), TrueFlight::at_hours(6.0),
                                           TrueFlight::at_hours(12.0)};
  BoundSettings without_bias;
  without_bias.bias_sigma = 0.0;
  const std::vector<double> with = position_bound(whole_flight(), epochs);
  const std::vector<double> without = position_bound(whole_flight(), epochs, without_bias);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(without[k], with[k]);
  EXPECT_LT(with[1], with[0]);
  EXPECT_LT(with[2], with[1]);
  // Within the first hour there is hardly a way to tell the range: what was known beforehand stands.
  EXPECT_GT(with[0], 300.0);
}

TEST(AnglesOnly, StraysDoNotMatter) {
  static const TrueFlight flight = fly_truly(6.0);
  SensorErrors errors;
  errors.outlier_share = 0.05;
  const Outcome outcome = navigate(flight, errors, 1);
  ASSERT_EQ(outcome.waypoints.size(), 1u);
  EXPECT_EQ(outcome.counters.restarts, 0);
  EXPECT_EQ(outcome.counters.revisions, 0);
  EXPECT_LT(outcome.waypoints[0].error_m, 130.0);  // three sigma of the filter's 44 m
}

}  // namespace
}  // namespace vbar::test
