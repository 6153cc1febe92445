// The filter's phase wander against generalised least squares. Two coincident spacecraft of known orbit leave only the
// clock of each epoch, the ambiguities and the wander unknown; channels of equal noise are exchangeable, so that the
// difference of two of them depends on their own phases only: a constant in Gauss-Markov and white noise.

#include "fsw/sources/carrier_pair/carrier_filter.h"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/unit/fsw/sources/carrier_pair/trunk_pair.h"

namespace vbar::fsw::sources {
namespace {

constexpr std::size_t kSatellites = 5;
constexpr double kWander_m = 1.5e-3;
constexpr double kWanderTime_s = 60.0;
constexpr double kPhase_m = 0.9e-3;  // single difference
constexpr double kCycles = 15.0;     // of each channel against that before it
// Orbit, antennas and prior of the ambiguities contribute 1e-4 of the variances below.
constexpr double kTolerance = 5e-4;

filter::FilterSettings known_orbit(double wander_sigma_m) {
  filter::FilterSettings settings;
  settings.earth = test::kEarth;
  settings.relative_orbit.acceleration = {.psd = 1e-24, .psd_min = 1e-24, .psd_max = 1e-24};
  settings.relative_orbit.along_track.sigma = 1e-13;
  settings.relative_orbit.from_sun.sigma = 1e-13;
  settings.relative_orbit.empirical.sigma = 1e-13;
  // Of a single difference: two receivers.
  settings.processes.of<PhaseWander>() = {.sigma = std::sqrt(2.0) * wander_sigma_m, .time_s = kWanderTime_s};
  return settings;
}

class KnownOrbit {
 public:
  explicit KnownOrbit(double wander_sigma_m = kWander_m, double phase_sigma_m = kPhase_m)
      : phase_sigma_m_(phase_sigma_m) {
    estimator->configure(known_orbit(wander_sigma_m));
    estimator->advance_to(time, {});
    const orbit::CartesianState servicer = navigation::test::servicer_start();
    estimator->set_states(servicer, servicer);
    // A micrometre: known, and far above rounding.
    estimator->initialize_relative(Vector6::Zero(), 1e-26 * Matrix6::Identity(), filter::SolutionStatus::kEstimated);
    carrier.configure({.antenna_offset_sigma_m = 1e-9, .phase_centre_jitter_m = 1e-9});
    carrier.activate_blocks(*estimator);
  }

  /// The next epoch, `dt_s` after the last; each phase is the ambiguity plus noise that no gate refuses.
  void take(double dt_s, std::size_t satellites = kSatellites) {
    time = time + nearest_duration(dt_s);
    // In two steps, as with a burn between.
    estimator->advance_to(time - nearest_duration(0.3 * dt_s), {});
    estimator->advance_to(time, {});
    navigation::DifferentialEpoch epoch;
    epoch.time = time;
    epoch.count = satellites;
    const double clock_m = 5.0 * normal_(random_);
    for (std::size_t k = 0; k < satellites; ++k) {
      navigation::DifferentialObservation& o = epoch.observations[k];
      o.satellite = {gnss::Constellation::kGps, static_cast<std::uint8_t>(k + 1)};
      o.code_m = clock_m;
      o.code_sigma_m = 100.0;
      o.phase_usable = true;
      o.phase_m = clock_m + kCycles * gnss::wavelength(gnss::Signal::kGpsL1) * static_cast<double>(k) +
                  0.5e-3 * normal_(random_);
      o.phase_sigma_m = phase_sigma_m_;
      o.servicer_lock_s = o.target_lock_s = seconds(time - locked_since);
      const double angle = 1.2 * static_cast<double>(k);
      o.servicer_source_eci = o.target_source_eci = 2.66e7 * Vector3(std::cos(angle), std::sin(angle), 0.5);
      phases[k].push_back(o.phase_m);
    }
    times.push_back(seconds(time - GpsTime{}));
    carrier.process_epoch(epoch, AntennaPlatform{}, AntennaPlatform{}, *estimator);
  }

  /// All carriers are acquired again at `time`.
  void lose_lock() {
    locked_since = time;
    times.clear();
    for (std::vector<double>& of_satellite : phases) of_satellite.clear();
  }

  /// Mean and variance of the difference of two channels' components.
  template <class Index>
  [[nodiscard]] double mean(const Index& index, std::size_t a, std::size_t b) const {
    return estimator->estimate().mean(index(a)) - estimator->estimate().mean(index(b));
  }
  template <class Index>
  [[nodiscard]] double variance(const Index& index, std::size_t a, std::size_t b) const {
    const filter::Estimate& e = estimator->estimate();
    return e.variance(index(a)) - 2.0 * e.covariance(index(a), index(b)) + e.variance(index(b));
  }

  std::unique_ptr<filter::RelativeNavigationFilter> estimator = std::make_unique<filter::RelativeNavigationFilter>();
  CarrierFilter carrier;
  GpsTime time = test::start_time();
  GpsTime locked_since = time - duration_of_seconds(1000);
  std::vector<double> times;
  std::array<std::vector<double>, kSatellites> phases;

 private:
  double phase_sigma_m_;
  std::mt19937_64 random_{17};
  std::normal_distribution<double> normal_;
};

/// A constant `ambiguity` and the Gauss-Markov value `wander` at the last time, of the difference of two channels.
struct Reference {
  double ambiguity, ambiguity_variance;
  double wander, wander_variance;
};

/// `known_ambiguity`: not estimated.
Reference least_squares(const KnownOrbit& flight, std::size_t a, std::size_t b,
                        const double* known_ambiguity = nullptr) {
  const auto n = static_cast<Eigen::Index>(flight.times.size());
  Eigen::MatrixXd covariance(n, n);
  Eigen::VectorXd difference(n), with_last(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = [&](Eigen::Index k) { return flight.times[static_cast<std::size_t>(k)]; };
    // Two receivers, two channels.
    const auto wander = [&](Eigen::Index j) {
      return 4.0 * kWander_m * kWander_m * std::exp(-std::abs(at(i) - at(j)) / kWanderTime_s);
    };
    for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = wander(j) + (i == j ? 2.0 * kPhase_m * kPhase_m : 0.0);
    with_last(i) = wander(n - 1);
    difference(i) = flight.phases[a][static_cast<std::size_t>(i)] - flight.phases[b][static_cast<std::size_t>(i)];
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
  const Eigen::VectorXd weights = factor.solve(ones);
  const Eigen::VectorXd gain = factor.solve(with_last);
  Reference reference{};
  reference.ambiguity_variance = known_ambiguity ? 0.0 : 1.0 / weights.sum();
  reference.ambiguity = known_ambiguity ? *known_ambiguity : reference.ambiguity_variance * weights.dot(difference);
  reference.wander = gain.dot(difference - reference.ambiguity * ones);
  const double left = gain.sum();
  reference.wander_variance =
      4.0 * kWander_m * kWander_m - gain.dot(with_last) + left * left * reference.ambiguity_variance;
  return reference;
}

void expect_reference(const KnownOrbit& flight, const Reference& reference, std::size_t a, std::size_t b) {
  const auto ambiguity = CarrierFilter::ambiguity_index;
  const auto wander = CarrierFilter::wander_index;
  EXPECT_NEAR(flight.variance(ambiguity, a, b), reference.ambiguity_variance,
              kTolerance * reference.ambiguity_variance);
  EXPECT_NEAR(flight.mean(ambiguity, a, b), reference.ambiguity, 1e-3 * std::sqrt(reference.ambiguity_variance));
  EXPECT_NEAR(flight.variance(wander, a, b), reference.wander_variance, kTolerance * reference.wander_variance);
  EXPECT_NEAR(flight.mean(wander, a, b), reference.wander, 1e-3 * std::sqrt(reference.wander_variance));
}

TEST(CarrierFilter, AmbiguitiesAndWanderAreTheLeastSquaresSolution) {
  KnownOrbit flight;
  for (const double dt_s : {10.0, 10.0, 10.0, 30.0, 1.0, 5.0, 100.0, 10.0, 10.0, 20.0}) {
    flight.take(dt_s);
    for (const std::size_t k : {1U, 4U}) expect_reference(flight, least_squares(flight, k, 0), k, 0);
  }
}

// The best mean of n samples of a Gauss-Markov process of correlation e from one to the next has the variance
// sigma^2 (1 + e) / (n - (n - 2) e); n of them as white noise would have sigma^2 / n, less than a sixth of it here.
TEST(CarrierFilter, AnAverageIsAsUncertainAsThatOfTheProcess) {
  KnownOrbit flight(kWander_m, 1e-7);
  const double e = std::exp(-10.0 / kWanderTime_s);
  for (int n = 1; n <= 30; ++n) {
    flight.take(10.0);
    const double expected = 4.0 * kWander_m * kWander_m * (1.0 + e) / (n - (n - 2) * e);
    EXPECT_NEAR(flight.variance(CarrierFilter::ambiguity_index, 2, 0), expected, 1e-3 * expected) << n;
  }
}

TEST(CarrierFilter, HeldIntegersLeaveItFree) {
  KnownOrbit flight;
  for (int k = 0; k < 6; ++k) flight.take(10.0);
  for (const std::size_t k : {1U, 2U, 3U, 4U})
    flight.carrier.hold(*flight.estimator, k, 0, kCycles * static_cast<double>(k));
  const double known_m = kCycles * gnss::wavelength(gnss::Signal::kGpsL1);
  for (int k = 0; k < 12; ++k) {
    flight.take(10.0);
    const Reference reference = least_squares(flight, 1, 0, &known_m);
    EXPECT_LT(flight.variance(CarrierFilter::ambiguity_index, 1, 0), 1.001e-8);
    // Integers are held to 0.1 mm, a hundredth of the wander's variance.
    EXPECT_NEAR(flight.variance(CarrierFilter::wander_index, 1, 0), reference.wander_variance,
                0.02 * reference.wander_variance);
    EXPECT_NEAR(flight.mean(CarrierFilter::wander_index, 1, 0), reference.wander, 2e-4);
  }
}

TEST(CarrierFilter, ARestartedChannelForgetsIt) {
  KnownOrbit flight;
  for (int k = 0; k < 8; ++k) flight.take(10.0);
  flight.lose_lock();
  for (int k = 0; k < 5; ++k) {
    flight.take(10.0);
    expect_reference(flight, least_squares(flight, 3, 0), 3, 0);
  }
}

TEST(CarrierFilter, AReleasedChannelIsInactive) {
  KnownOrbit flight;
  for (int k = 0; k < 3; ++k) flight.take(10.0);
  const std::size_t last = kSatellites - 1;
  EXPECT_FALSE(flight.estimator->estimate().is_inactive(CarrierFilter::wander_index(last)));
  for (int k = 0; k < 13; ++k) flight.take(10.0, last);
  EXPECT_TRUE(flight.estimator->estimate().is_inactive(CarrierFilter::wander_index(last)));
  EXPECT_TRUE(flight.estimator->estimate().is_inactive(CarrierFilter::ambiguity_index(last)));
  EXPECT_FALSE(flight.estimator->estimate().is_inactive(CarrierFilter::wander_index(0)));
  flight.carrier.release(*flight.estimator, 0.05);
  for (std::size_t k = 0; k < kPhaseChannels; ++k)
    EXPECT_TRUE(flight.estimator->estimate().is_inactive(CarrierFilter::wander_index(k))) << k;
}

TEST(CarrierFilter, NoneIsEstimatedWithoutASigma) {
  KnownOrbit flight(0.0);
  for (int k = 0; k < 3; ++k) flight.take(10.0);
  for (std::size_t k = 0; k < kPhaseChannels; ++k) {
    EXPECT_TRUE(flight.estimator->estimate().is_inactive(CarrierFilter::wander_index(k))) << k;
    EXPECT_EQ(flight.estimator->estimate().mean(CarrierFilter::wander_index(k)), 0.0) << k;
  }
  // White noise of n phases.
  EXPECT_NEAR(flight.variance(CarrierFilter::ambiguity_index, 1, 0), 2.0 * kPhase_m * kPhase_m / 3.0,
              kTolerance * kPhase_m * kPhase_m);
}

}  // namespace
}  // namespace vbar::fsw::sources
