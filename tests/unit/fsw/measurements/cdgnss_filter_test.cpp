// The filter's phase wander against generalised least squares. Two coincident spacecraft of known orbit leave only the
// clock of each epoch, the ambiguities and the wander unknown; channels of equal noise are exchangeable, so that the
// difference of two of them depends on their own phases only: a constant in Gauss-Markov and white noise.

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fsw/estimation/unscented.h"
#include "fsw/measurements/cdgnss/carrier_filter.h"
#include "fsw/measurements/cdgnss/single_differences.h"
#include "fsw/orbit/roe.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/measurements/cdgnss_pair.h"

namespace vbar::fsw::measurements {

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
  settings.relative_orbit.drag.sigma = 1e-13;
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
    const orbit::CartesianState servicer = gnss::test::servicer_start();
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
    gnss::DifferentialEpoch epoch;
    epoch.time = time;
    epoch.count = satellites;
    const double clock_m = 5.0 * normal_(random_);
    for (std::size_t k = 0; k < satellites; ++k) {
      gnss::DifferentialObservation& o = epoch.observations[k];
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
  for (int k = 0; k < 14; ++k) flight.take(10.0, last);
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

namespace {

/// Position at reception in extended precision is not available; that of a first-order map of the inertial state is,
/// where the differences of positions of seven thousand kilometres are metres.
struct Case {
  orbit::CartesianState servicer = gnss::test::servicer_start();
  orbit::QnsElements chief = orbit::qns_from_cartesian(servicer).value();
  Vector6 roe = Vector6(-0.5, 9.0, 3.0, -4.0, 2.0, 1.0) / chief.a;
};

// The Jacobian against that of a step 30 times as large, extrapolated (Richardson): agreement to 1e-9 of a range.
TEST(DifferenceRows, JacobianOfThePositionIsExactTo1e8) {
  const Case c;
  constexpr double kClock_m = 1.5e6;  // 5 ms
  const auto map = reception_map(c.servicer, c.roe, Matrix6::Zero(), kClock_m);
  ASSERT_TRUE(map.ok());
  const auto position = [&](const Vector6& roe) {
    return position_at_reception(orbit::target_from_roe(c.chief, roe).value(), kClock_m);
  };
  for (int k = 0; k < 6; ++k) {
    const auto slope = [&](double step) -> Vector3 {
      return (position(c.roe + step * Vector6::Unit(k)) - position(c.roe - step * Vector6::Unit(k))) / (2.0 * step);
    };
    const Vector3 reference = (4.0 * slope(1.5e-5) - slope(3e-5)) / 3.0;
    EXPECT_LT((map.value().jacobian.col(k) - reference).norm(), 1e-8 * reference.norm()) << k;
  }
}

// A regression over sigma points of a tenth of a millimetre loses digits, which is why it is not used there.
TEST(DifferenceRows, ARegressionOverMillimetresIsLessAccurate) {
  const Case c;
  using Transform = estimation::UnscentedTransform<6>;
  const auto exact = reception_map(c.servicer, c.roe, Matrix6::Zero(), 0.0);
  ASSERT_TRUE(exact.ok());
  for (const double sigma_m : {1e-4, 1e-3, 1e-2, 1.0, 100.0}) {
    Transform transform;
    const double sigma = sigma_m / c.chief.a;
    ASSERT_EQ(transform.start(c.roe, sigma * sigma * Matrix6::Identity()), Status::kOk);
    std::array<Vector3, Transform::kPoints> positions;
    for (std::size_t k = 0; k < Transform::kPoints; ++k) {
      positions[k] = orbit::target_from_roe(c.chief, transform.point(k)).value().position_eci;
    }
    const auto regression = transform.regress<3>(positions);
    const double error = (regression.jacobian - exact.value().jacobian).norm() / exact.value().jacobian.norm();
    if (sigma_m >= 1.0) {
      EXPECT_LT(error, 1e-6) << sigma_m;
    }
    if (sigma_m <= 1e-4) {
      EXPECT_GT(error, 1e-6) << sigma_m;
    }
  }
}

// Beyond 35 m the map is sampled: mean and nonlinearity are those of a second-order expansion. A mean longitude of
// sigma s displaces the target by a s^2 / 2 towards the Earth, and half of its square is that variance's.
TEST(DifferenceRows, AnUncertainOrbitIsSampled) {
  const Case c;
  Matrix6 covariance = 1e-16 * Matrix6::Identity();
  constexpr double kSigma = 1e-4;  // 700 m
  covariance(1, 1) = kSigma * kSigma;
  const auto map = reception_map(c.servicer, c.roe, covariance, 0.0);
  ASSERT_TRUE(map.ok());
  const Vector3 radial = c.servicer.position_eci.normalized();
  const double drop = 0.5 * c.servicer.position_eci.norm() * kSigma * kSigma;
  const Vector3 point = orbit::target_from_roe(c.chief, c.roe).value().position_eci;
  EXPECT_NEAR((map.value().position_eci - point).dot(radial), -drop, 0.02 * drop);
  // E[x^4] - E[x^2]^2 = 2 s^4.
  EXPECT_NEAR(radial.dot(map.value().nonlinearity * radial), 2.0 * drop * drop, 0.1 * drop * drop);
}

TEST(DifferenceRows, ResidualsAndSensitivitiesAreDerivatives) {
  test::FilterPair pair(21);
  pair.fly_filter(6);
  const gnss::ObservationEpoch ours = pair.servicer.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const gnss::ObservationEpoch theirs = pair.target.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const auto frame = gnss::EarthFrame::at(pair.estimator->epoch(), test::kEarth);
  gnss::DifferentialEpoch epoch;
  gnss::form_differences(ours, theirs, pair.store, frame, epoch);
  const AntennaPlatform servicer{pair.servicer.R_eci_body_at(epoch.time), pair.nominal_antenna_m, 9e4};
  const AntennaPlatform target{pair.target.R_eci_body_at(epoch.time), pair.nominal_antenna_m, -1.35e5};
  DifferenceRows rows, moved;
  ASSERT_EQ(rows.form(epoch, servicer, target, *pair.estimator), Status::kOk);
  ASSERT_GT(epoch.count, 10U);
  using filter::kAt;
  const std::array<int, 11> components = {0,
                                          1,
                                          4,
                                          kAt<ServicerAntenna> + 1,
                                          kAt<TargetAntenna> + 2,
                                          kAt<PhaseCentreJitter>,
                                          kAt<ClockDifference>,
                                          kAt<Ambiguities> + 3,
                                          kAt<CodeBiases>,
                                          kAt<Ionosphere>,
                                          kAt<Ionosphere> + 1};
  for (const int i : components) {
    const double step = i < 6 ? 1.0 / 7e6 : 1.0;
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, epoch.count - 1}) {
      const auto& o = epoch.observations[n];
      const auto values = [&](const DifferenceRows& of) {
        return std::pair(of.code_residual(n, o, pair.estimator->estimate()),
                         of.phase_residual(n, 3, o, pair.estimator->estimate()));
      };
      const auto before = values(rows);
      pair.estimator->estimate().shift(i, step);
      const auto linear = values(rows);
      ASSERT_EQ(moved.form(epoch, servicer, target, *pair.estimator), Status::kOk);
      const auto exact = values(moved);
      pair.estimator->estimate().shift(i, -step);
      // The residual falls by the sensitivity; the model formed anew differs by curvature: (1 m)^2 / a.
      EXPECT_NEAR(linear.first - before.first, -step * rows.code_sensitivity(n, o.signal)(i), 1e-8) << i;
      EXPECT_NEAR(linear.second - before.second, -step * rows.phase_sensitivity(n, 3, o.signal)(i), 1e-8) << i;
      EXPECT_NEAR(exact.first, linear.first, 3e-7) << i;
      EXPECT_NEAR(exact.second, linear.second, 3e-7) << i;
    }
  }
}

// The ionosphere delays codes and advances phases, by the square of the wavelength: 1.647 as much at L2 as at L1. Of a
// target at the place of the servicer there is hardly a difference.
TEST(DifferenceRows, IonosphereDelaysCodesAndAdvancesPhases) {
  test::FilterPair pair(21);
  pair.fly_filter(6);
  const gnss::ObservationEpoch ours = pair.servicer.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const gnss::ObservationEpoch theirs = pair.target.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const auto frame = gnss::EarthFrame::at(pair.estimator->epoch(), test::kEarth);
  gnss::DifferentialEpoch epoch;
  gnss::form_differences(ours, theirs, pair.store, frame, epoch);
  const AntennaPlatform platform{pair.servicer.R_eci_body_at(epoch.time), pair.nominal_antenna_m, 0.0};
  constexpr int kVertical = filter::kAt<Ionosphere>;
  const auto chief = orbit::qns_from_cartesian(pair.estimator->servicer()).value();
  filter::RelativeNavigationFilter& filter = *pair.estimator;
  DifferenceRows rows;
  for (const double distance_m : {0.0, 1000.0}) {
    const Vector6 roe = -distance_m / chief.a * Vector6::Unit(1);
    filter.initialize_relative(roe, 1e-20 * Matrix6::Identity(), filter::SolutionStatus::kEstimated);
    ASSERT_EQ(rows.form(epoch, platform, platform, filter), Status::kOk);
    accuracy::Largest largest;
    for (std::size_t n = 0; n < epoch.count; ++n) {
      const double l1 = rows.code_sensitivity(n, gnss::Signal::kGpsL1)(kVertical);
      largest.add(std::abs(l1));
      EXPECT_NEAR(rows.code_sensitivity(n, gnss::Signal::kGpsL2)(kVertical), 1.6469444 * l1, 1e-6 * std::abs(l1));
      EXPECT_EQ(rows.phase_sensitivity(n, 0, gnss::Signal::kGpsL1)(kVertical), -l1);
    }
    // The two signals leave a satellite up to a millisecond apart, which is 2e-7 rad of its path. A kilometre is 1.4e-4
    // rad of the direction of the zenith, and the slant factor rises by up to 30 per radian.
    if (distance_m == 0.0) {
      EXPECT_LT(largest, 1e-5);
    } else {
      EXPECT_GT(largest, 3e-5);
      EXPECT_LT(largest, 5e-3);
    }
  }
}

}  // namespace

}  // namespace vbar::fsw::measurements
