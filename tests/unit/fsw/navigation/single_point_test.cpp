#include "fsw/navigation/single_point.h"

#include <gtest/gtest.h>

#include "tests/unit/fsw/navigation/cooperating_pair.h"

namespace vbar::fsw::navigation {
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
}  // namespace vbar::fsw::navigation
