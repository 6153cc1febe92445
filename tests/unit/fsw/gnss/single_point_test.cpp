#include "fsw/gnss/single_point.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/unit/fsw/gnss/synthetic_receivers.h"

namespace vbar::fsw::gnss {
namespace {

using test::CooperatingPair;
using test::kEarth;

struct OneReceiver : CooperatingPair {
  OneReceiver() : CooperatingPair(1) {
    for (const gnss::Ephemeris& ephemeris : satellites) EXPECT_EQ(store.put(ephemeris), Status::kOk);
  }
  [[nodiscard]] gnss::ObservationEpoch epoch() { return servicer.observe(tag, satellites, kEarth); }
  [[nodiscard]] Result<SinglePoint> solve(const gnss::ObservationEpoch& observed) const {
    return single_point(observed, store, EarthFrame::at(tag, kEarth));
  }
  [[nodiscard]] Vector3 antenna() const {
    const orbit::CartesianState state = servicer.state_at(tag);
    return state.position_eci - servicer.clock_s * state.velocity_eci +
           servicer.R_eci_body_at(tag) * servicer.antenna_body_m;
  }
  EphemerisStore store;
};

TEST(SinglePoint, WithoutNoiseIsExact) {
  OneReceiver receiver;
  receiver.servicer.code_sigma_m = 0.0;
  const auto point = receiver.solve(receiver.epoch());
  ASSERT_TRUE(point.ok());
  // The time of transmission is kept to a nanosecond: 4 um; the convergence limit is 0.1 mm.
  EXPECT_NEAR(point.value().clock_m, 0.3e-3 * gnss::kSpeedOfLight, 1e-3);
  EXPECT_LT((point.value().position_eci - receiver.antenna()).norm(), 2e-3);
}

// The covariance is the inverse normal matrix of position and clock: here with directions from the true antenna and
// the variance of an ionosphere-free combination (Misra and Enge, 2nd ed., eq. 5.39) plus that of broadcast orbits.
TEST(SinglePoint, CovarianceIsTheInverseNormalMatrix) {
  OneReceiver receiver;
  const gnss::ObservationEpoch epoch = receiver.epoch();
  const auto point = receiver.solve(epoch);
  ASSERT_TRUE(point.ok());
  const EarthFrame frame = EarthFrame::at(receiver.tag, kEarth);
  const double ratio = std::pow(gnss::kL1_Hz / gnss::kL2_Hz, 2);
  const double noise = receiver.servicer.code_sigma_m * std::sqrt(ratio * ratio + 1.0) / (ratio - 1.0);
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  for (std::size_t k = 0; k < epoch.count; k += 2) {
    const auto source = signal_source(epoch.observations[k].satellite, epoch.observations[k].pseudorange_m,
                                      epoch.receiver_time, receiver.store, frame);
    ASSERT_TRUE(source.ok());
    Eigen::Vector4d row;
    row << (receiver.antenna() - source.value().position_eci).normalized(), 1.0;
    normal += row * row.transpose() / (noise * noise + 1.5 * 1.5);
  }
  const Matrix3 expected = normal.inverse().topLeftCorner<3, 3>();
  // Directions of the solution, metres from the truth at 20,000 km.
  EXPECT_LT((point.value().covariance_m2 - expected).norm(), 1e-5 * expected.norm());
  EXPECT_NEAR(point.value().sigma_m, std::sqrt(expected.trace() / 3.0), 1e-5);
}

// Errors of many epochs with noise of 5 m, beside which broadcast orbits of 1.5 m are 1 % of the variance.
TEST(SinglePoint, CovarianceIsThatOfTheErrors) {
  OneReceiver receiver;
  receiver.servicer.code_sigma_m = 5.0;
  double normalised = 0.0;
  constexpr int kEpochs = 400;
  for (int k = 0; k < kEpochs; ++k) {
    const auto point = receiver.solve(receiver.epoch());
    ASSERT_TRUE(point.ok());
    const Vector3 error = point.value().position_eci - receiver.antenna();
    normalised += error.dot(point.value().covariance_m2.inverse() * error) / kEpochs;
  }
  // 3 +- 3 sqrt(6 / 400), less the 1 % of broadcast orbits.
  EXPECT_NEAR(normalised, 2.97, 3.0 * std::sqrt(6.0 / kEpochs));
}

TEST(SinglePoint, LeavesOutAFaultySatellite) {
  OneReceiver receiver;
  gnss::ObservationEpoch epoch = receiver.epoch();
  const gnss::SatelliteId faulty = epoch.observations[0].satellite;
  for (gnss::Observation& o : epoch.observations) {
    if (o.satellite == faulty) o.pseudorange_m += 5000.0;
  }
  const auto point = receiver.solve(epoch);
  ASSERT_TRUE(point.ok());
  // Ionosphere-free code of 0.4 m has 1.2 m; geometry doubles it; four of those.
  EXPECT_LT((point.value().position_eci - receiver.antenna()).norm(), 10.0);
}

/// A fault of 30 m moves the solution by metres, and residuals of others can become larger than that of the faulty
/// satellite. The reference is the solution of an epoch that lacks it.
TEST(SinglePoint, LeavesOutTheSatelliteOfASmallFault) {
  OneReceiver receiver;
  const gnss::ObservationEpoch observed = receiver.epoch();
  std::size_t faults = 0;
  for (std::size_t k = 0; k < observed.count; ++k) {
    if (observed.observations[k].signal != gnss::Signal::kGpsL1) continue;
    const gnss::SatelliteId faulty = observed.observations[k].satellite;
    gnss::ObservationEpoch epoch = observed, without;
    without.receiver_time = observed.receiver_time;
    for (std::size_t n = 0; n < observed.count; ++n) {
      if (observed.observations[n].satellite != faulty) {
        without.observations[without.count++] = observed.observations[n];
      } else {
        epoch.observations[n].pseudorange_m += 30.0;
      }
    }
    const auto expected = receiver.solve(without), point = receiver.solve(epoch);
    ASSERT_TRUE(expected.ok() && point.ok());
    EXPECT_EQ(point.value().used, expected.value().used) << k;
    // Both iterations end within 0.1 mm.
    EXPECT_LT((point.value().position_eci - expected.value().position_eci).norm(), 1e-3) << k;
    ++faults;
  }
  EXPECT_GE(faults, 6U);
}

TEST(SinglePoint, TooFewSatellitesAreNoSolution) {
  OneReceiver receiver;
  for (const std::size_t satellites : {0U, 1U, 3U, 4U}) {
    gnss::ObservationEpoch epoch = receiver.epoch();
    epoch.count = 2 * satellites;
    EXPECT_EQ(receiver.solve(epoch).status(), Status::kNotReady) << satellites;
  }
}

TEST(SinglePoint, WhatIsNoNumberIsNotUsed) {
  OneReceiver receiver;
  gnss::ObservationEpoch epoch = receiver.epoch();
  epoch.observations[0].pseudorange_m = NAN;
  epoch.observations[3].pseudorange_m = -1e9;
  epoch.observations[4].pseudorange_sigma_m = NAN;
  const auto point = receiver.solve(epoch);
  ASSERT_TRUE(point.ok());
  EXPECT_LT((point.value().position_eci - receiver.antenna()).norm(), 10.0);
}

TEST(SinglePoint, WithoutEphemeridesIsNotReady) {
  OneReceiver receiver;
  receiver.store = EphemerisStore{};
  EXPECT_EQ(receiver.solve(receiver.epoch()).status(), Status::kNotReady);
}

}  // namespace
}  // namespace vbar::fsw::gnss
