// Noise of known standard deviation and correlation, found again in differences between two receivers.

#include "host_sim/sensors/gnss/difference_noise.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/report/run_record.h"
#include "host_sim/sensors/gnss/gnss_kind.h"

namespace vbar::sensors {
namespace {

using fsw::Vector3;
using fsw::gnss::DifferentialEpoch;
using fsw::gnss::DifferentialObservation;
using fsw::gnss::Signal;

constexpr int kSatellites = 12;
constexpr std::array<Signal, 2> kSignals{Signal::kGpsL1, Signal::kGpsL2};
constexpr double kPeriod_s = 10.0;

/// First-order Gauss-Markov: correlation exp(-t/time).
class GaussMarkov {
 public:
  GaussMarkov(double sigma, double time_s) : sigma_(sigma), decay_(std::exp(-kPeriod_s / time_s)) {}
  double next(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const double drawn = sigma_ * normal(random);
    value_ = started_ ? decay_ * value_ + std::sqrt(1.0 - decay_ * decay_) * drawn : drawn;
    started_ = true;
    return value_;
  }

 private:
  double sigma_, decay_;
  double value_ = 0.0;
  bool started_ = false;
};

/// Two receivers 10 m apart, satellites that pass over them, and channels with noise of their own.
class Scene {
 public:
  struct Noise {
    double phase_white_m = 0.5e-3;
    double phase_wander_m = 0.0, phase_wander_time_s = 60.0;
    double code_m = 0.2, code_time_s = 1e-3;  ///< that short a time is white noise
  };

  explicit Scene(const Noise& noise) : noise_(noise), random_(17) {
    for (int k = 0; k < 2 * 2 * kSatellites; ++k) {
      wander_.emplace_back(noise.phase_wander_m, noise.phase_wander_time_s);
      code_.emplace_back(noise.code_m, noise.code_time_s);
    }
  }

  /// `baseline_error`: between the receivers' true distance and the one that the statistics are given.
  DifferentialEpoch next() {
    DifferentialEpoch epoch;
    epoch.time = fsw::GpsTime{} + fsw::nearest_duration(kPeriod_s * step_);
    std::size_t channel = 0;
    for (int satellite = 0; satellite < kSatellites; ++satellite) {
      const Vector3 source = source_of(satellite);
      for (const Signal signal : kSignals) {
        DifferentialObservation& d = epoch.observations[epoch.count++];
        d.satellite = {fsw::gnss::Constellation::kGps, static_cast<std::uint8_t>(satellite + 1)};
        d.signal = signal;
        d.servicer_source_eci = d.target_source_eci = source;
        d.phase_usable = true;
        d.servicer_lock_s = d.target_lock_s = 1e4;
        d.phase_sigma_m = std::sqrt(2.0) * std::hypot(noise_.phase_white_m, noise_.phase_wander_m);
        d.code_sigma_m = std::sqrt(2.0) * noise_.code_m;
        const double range = (source - kServicer - true_baseline).norm() - (source - kServicer).norm();
        const double clocks_m = 37.123 + 5.0 * step_;
        d.phase_m = range + clocks_m + fsw::gnss::wavelength(signal) * (1000.0 + 7.0 * satellite + integer_step);
        d.code_m = range + clocks_m;
        for (const double sign : {1.0, -1.0}) {
          d.phase_m += sign * (noise_.phase_white_m * normal_(random_) + wander_[channel].next(random_));
          d.code_m += sign * code_[channel].next(random_);
          ++channel;
        }
      }
    }
    ++step_;
    return epoch;
  }

  static Vector3 source_of(int satellite) {
    // A spiral over the upper half of the sky.
    const double height = 0.1 + 0.9 * satellite / kSatellites;
    const double azimuth = 2.4 * satellite;
    const double across = std::sqrt(1.0 - height * height);
    return kServicer + 2.2e7 * Vector3(across * std::cos(azimuth), across * std::sin(azimuth), height);
  }

  static inline const Vector3 kServicer{0.0, 0.0, 7.0e6};
  Vector3 true_baseline{3.0, -8.0, 2.0};
  int integer_step = 0;  ///< a slip of all phases

 private:
  Noise noise_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<GaussMarkov> wander_, code_;
  int step_ = 0;
};

const Vector3 kGivenBaseline(3.0, -8.0, 2.0);

std::vector<SignalNoiseRow> rows_of(Scene& scene, int epochs) {
  DifferenceNoise noise;
  for (int k = 0; k < epochs; ++k)
    if (const auto epoch = residuals_of(scene.next(), Scene::kServicer, kGivenBaseline)) noise.add(*epoch);
  return noise.rows();
}

// 2000 epochs of 12 satellites: a sigma is known to 1/sqrt(2 x 24000) = 0.5 % and a correlation of white noise to
// 0.006; correlated over 60 s the number of independent samples is about a tenth.
TEST(DifferenceNoise, WhiteNoiseHasItsSigmaAndNoCorrelation) {
  Scene scene({});
  const auto rows = rows_of(scene, 2000);
  ASSERT_EQ(rows.size(), 2U);
  for (const SignalNoiseRow& row : rows) {
    // Four channels make a double difference.
    EXPECT_NEAR(row.phase_sigma_mm.value(), 2.0 * 0.5, 0.02);
    EXPECT_NEAR(row.phase_sigma_stated_mm.value(), 2.0 * 0.5, 1e-9);
    EXPECT_NEAR(row.phase_correlation_10s.value(), 0.0, 0.025);
    EXPECT_NEAR(row.code_sigma_m.value(), 2.0 * 0.2, 0.008);
    EXPECT_NEAR(row.code_correlation_10s.value(), 0.0, 0.025);
    EXPECT_FALSE(row.phase_wander_sigma_mm);
    EXPECT_EQ(row.measurements, 24000U);
    EXPECT_EQ(row.excluded, 0U);
  }
  EXPECT_EQ(rows[0].signal, "GPS L1");
  EXPECT_EQ(rows[1].signal, "GPS L2");
}

TEST(DifferenceNoise, CorrelatedNoiseHasTheAnalyticCorrelation) {
  Scene scene({.phase_white_m = 0.5e-3,
               .phase_wander_m = 1e-3,
               .phase_wander_time_s = 60.0,
               .code_m = 0.1,
               .code_time_s = 100.0});
  for (const SignalNoiseRow& row : rows_of(scene, 4000)) {
    EXPECT_NEAR(row.phase_sigma_mm.value(), 2.0 * std::hypot(0.5, 1.0), 0.05);
    EXPECT_NEAR(row.phase_correlation_10s.value(), std::exp(-10.0 / 60.0) / 1.25, 0.02);
    EXPECT_NEAR(row.code_correlation_10s.value(), std::exp(-10.0 / 100.0), 0.02);
    EXPECT_NEAR(row.code_sigma_m.value(), 2.0 * 0.1, 0.01);
    EXPECT_NEAR(row.phase_wander_sigma_mm.value(), 1.0, 0.05);
    EXPECT_NEAR(row.phase_wander_time_s.value(), 60.0, 6.0);
  }
}

TEST(DifferenceNoise, AnErrorOfTheBaselineIsNotNoise) {
  Scene scene({});
  scene.true_baseline += Vector3(0.01, -0.015, 0.012);
  const auto epoch = residuals_of(scene.next(), Scene::kServicer, kGivenBaseline);
  ASSERT_TRUE(epoch);
  // Differences of 0.7 mm from 24 phases: about 0.5 mm an axis.
  EXPECT_LT((epoch->baseline_correction_m - Vector3(0.01, -0.015, 0.012)).norm(), 3e-3);
  const auto rows = rows_of(scene, 1000);
  EXPECT_NEAR(rows[0].phase_sigma_mm.value(), 1.0, 0.03);
  EXPECT_NEAR(rows[0].phase_correlation_10s.value(), 0.0, 0.04);
}

TEST(DifferenceNoise, SlipsOfWholeCyclesDoNotMatter) {
  Scene scene({});
  DifferenceNoise noise;
  for (int k = 0; k < 500; ++k) {
    scene.integer_step = k % 7;
    noise.add(residuals_of(scene.next(), Scene::kServicer, kGivenBaseline).value());
  }
  EXPECT_NEAR(noise.rows()[0].phase_sigma_mm.value(), 1.0, 0.05);
}

TEST(DifferenceNoise, APhaseThatIsNoIntegerAwayIsExcluded) {
  Scene scene({});
  DifferentialEpoch differences = scene.next();
  differences.observations[4].phase_m += 0.5 * fsw::gnss::wavelength(Signal::kGpsL1);
  differences.observations[6].phase_m = std::numeric_limits<double>::quiet_NaN();
  const auto epoch = residuals_of(differences, Scene::kServicer, kGivenBaseline);
  ASSERT_TRUE(epoch);
  EXPECT_EQ(epoch->residuals.size(), 2U * kSatellites - 2U);
  EXPECT_EQ(epoch->excluded[0], 2U);
  for (const SignalResidual& residual : epoch->residuals) EXPECT_LT(std::abs(residual.phase.value_m), 5e-3);
}

TEST(DifferenceNoise, TooFewPhasesGiveNothing) {
  Scene scene({});
  DifferentialEpoch differences = scene.next();
  differences.count = 6;  // three satellites: five unknowns
  EXPECT_FALSE(residuals_of(differences, Scene::kServicer, kGivenBaseline));
  differences.count = 0;
  EXPECT_FALSE(residuals_of(differences, Scene::kServicer, kGivenBaseline));
}

TEST(DifferenceNoise, PairsEndWithTheLock) {
  Scene scene({.code_time_s = 1000.0});
  DifferenceNoise noise;
  for (int k = 0; k < 200; ++k) {
    DifferentialEpoch differences = scene.next();
    for (std::size_t n = 0; n < differences.count; ++n) differences.observations[n].target_lock_s = 5.0;
    noise.add(residuals_of(differences, Scene::kServicer, kGivenBaseline).value());
  }
  EXPECT_TRUE(noise.rows()[0].code_sigma_m);
  EXPECT_FALSE(noise.rows()[0].code_correlation_10s);
}

class TimeTo20mm : public testing::Test {
 protected:
  void step(double time_s, double error_m) {
    report::TruthRow truth;
    truth.time_s = time_s;
    truth.servicer_position_eci = {7e6, 0.0, 0.0};
    truth.servicer_velocity_eci = {0.0, 7500.0, 0.0};
    record.truth.push_back(truth);
    report::EstimateRow estimate;
    estimate.time_s = time_s;
    estimate.navigation_valid = 1;
    estimate.relative_position_rtn = {0.0, error_m, 0.0};
    record.estimates.push_back(estimate);
  }
  report::RunRecord record;
};

TEST_F(TimeTo20mm, IsTheFirstStepOfTheLastStayBelow) {
  int k = 0;
  for (const double error_m : {1.0, 0.015, 0.025, 0.0199, -0.01, 0.001}) step(1000.0 + 10.0 * k++, error_m);
  EXPECT_EQ(time_to_20_mm(record), 30.0);
}

TEST_F(TimeTo20mm, NeverIfTheRunEndsAbove) {
  EXPECT_FALSE(time_to_20_mm(record));
  step(0.0, 0.001);
  EXPECT_EQ(time_to_20_mm(record), 0.0);
  step(10.0, 0.02);
  EXPECT_FALSE(time_to_20_mm(record));
  step(20.0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(time_to_20_mm(record));
}

}  // namespace
}  // namespace vbar::sensors
