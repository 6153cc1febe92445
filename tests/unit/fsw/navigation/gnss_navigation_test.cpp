#include "fsw/navigation/gnss_navigation.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/navigation/cooperating_pair.h"

namespace vbar::fsw::navigation {
namespace {

using test::CooperatingPair;
using test::kEarth;

TEST(GnssNavigation, FixesWithinTwoMinutesAndFindsTheBaseline) {
  CooperatingPair pair(3);
  pair.fly(12);
  ASSERT_TRUE(pair.navigation->valid());
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_TRUE(pair.integers_are_true());
  // Phases of 0.7 mm, differenced, fourteen satellites: half a millimetre an axis; five of those.
  EXPECT_LT(pair.position_error(), 3e-3);
  pair.fly(60);
  EXPECT_LT((pair.error().tail<3>().norm()), 2e-5);  // a millimetre over the minutes that velocity is averaged
  EXPECT_EQ(pair.navigation->counters().restarts, 0);
  EXPECT_EQ(pair.navigation->counters().phases_refused, 0);
}

TEST(GnssNavigation, EveryHeldIntegerIsTheTrueOneOverFiftySeeds) {
  int fixed = 0;
  constexpr int kSeeds = vbar::test::share_under_sanitizers(50);
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    CooperatingPair pair(seed, 5e-3, 1e-3);
    pair.servicer.code_sigma_m = pair.target.code_sigma_m = 0.8;
    pair.fly(20);
    EXPECT_TRUE(pair.integers_are_true()) << seed;
    fixed += pair.navigation->ambiguities().is_fixed() ? 1 : 0;
  }
  EXPECT_EQ(fixed, kSeeds);
}

// Normalised error squared of the six relative states, over seeds, against chi-square with 6 degrees a seed of freedom.
TEST(GnssNavigation, IsConsistentWithItsErrors) {
  double nees = 0.0;
  double nis = 0.0;
  double nis_count = 0.0;
  constexpr int kSeeds = vbar::test::share_under_sanitizers(40);
  for (unsigned seed = 101; seed < 101 + kSeeds; ++seed) {
    // A vector of fixed length and random direction has length / sqrt(3) an axis: what the filter is told.
    CooperatingPair pair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3);
    // Nothing pushes these two apart: the truth is the filter's own model.
    pair.settings.relative.acceleration_sigma = 1e-10;
    pair.begin();
    for (int k = 0; k < 40; ++k) {
      pair.fly(1);
      if (k < 20) continue;
      nis += pair.navigation->last_update().phase_nis;
      nis_count += pair.navigation->last_update().phases_used;
    }
    const Vector6 error = pair.error();
    nees += error.dot(pair.navigation->covariance_rtn().inverse() * error);
  }
  // 95 % of its mean: 6 +- 1.96 sqrt(12 / seeds).
  EXPECT_NEAR(nees / kSeeds, 6.0, 1.96 * std::sqrt(12.0 / kSeeds));
  // Some 500 phases a seed, 1 +- 0.02 of 40 seeds; the clock and the position take their part of each epoch's degrees
  // of freedom through correlation, which sequential updates count properly.
  EXPECT_NEAR(nis / nis_count, 1.0, 0.05 * std::sqrt(40.0 / kSeeds));
}

TEST(GnssNavigation, ASlipReportedByTheReceiversIsCorrectedAtOnce) {
  CooperatingPair pair(5);
  pair.fly(15);
  for (std::size_t k = 0; k < 60; k += 7) {
    pair.target.cycles[k] += 3.0;
    pair.target.lock_start_s[k] = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  }
  pair.fly(1);
  EXPECT_GT(pair.navigation->counters().slips, 0);
  EXPECT_LT(pair.position_error(), 3e-3);
  pair.fly(10);
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

TEST(GnssNavigation, ASlipThatNobodyTellsIsFound) {
  for (const double cycles : {1.0, -1.0, 5.0, 1000.0}) {
    CooperatingPair pair(6);
    pair.fly(15);
    const std::size_t place = 2U * (pair.navigation->relative().channels()[0].satellite.prn - 1U);
    pair.target.cycles[place] += cycles;
    pair.fly(1);
    EXPECT_EQ(pair.navigation->counters().slips, 1) << cycles;
    EXPECT_LT(pair.position_error(), 3e-3) << cycles;
    pair.fly(10);
    EXPECT_TRUE(pair.integers_are_true()) << cycles;
  }
}

// At 5 ms the orbit has moved on by 37 m between the instant a receiver means and that of its measurements.
TEST(GnssNavigation, ClocksMayStandMillisecondsApart) {
  CooperatingPair pair(13);
  pair.servicer.clock_s = 5e-3;
  pair.target.clock_s = -5e-3;
  pair.fly(20);
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
  EXPECT_EQ(pair.navigation->counters().restarts, 0);
}

// One receiver is suddenly elsewhere, its phases begin anew: after five epochs nothing that was known counts.
TEST(GnssNavigation, ARelativeStateThatTheCodesContradictIsGivenUp) {
  CooperatingPair pair(14);
  pair.fly(20);
  pair.target.start.position_eci += orbit::R_rtn_eci(pair.target.start).transpose() * Vector3(0.0, 300.0, 0.0);
  for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  pair.fly(20);
  EXPECT_EQ(pair.navigation->counters().restarts, 1);
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

TEST(GnssNavigation, BurnsAreFollowed) {
  CooperatingPair pair(7);
  pair.fly(20);
  // A burn 4 s after the last epoch, as large as they come at close range.
  const GpsTime burn_time = pair.navigation->epoch() + duration_of_seconds(4);
  const Vector3 dv_rtn(0.002, -0.003, 0.001);
  const orbit::CartesianState before = pair.servicer.state_at(burn_time);
  const orbit::CartesianState after = orbit::apply_impulse_rtn(before, dv_rtn);
  pair.servicer.start = propagate_accelerated(after, Vector3::Zero(), -seconds(burn_time - test::start_time()));
  const std::array<Burn, 1> burns{{{burn_time, dv_rtn}}};
  pair.take(Receiver::kServicer);
  pair.take(Receiver::kTarget);
  pair.navigation->update(pair.tag, burns);
  EXPECT_LT(pair.position_error(), 3e-3);
  EXPECT_LT((pair.error().tail<3>().norm()), 5e-5);
  EXPECT_TRUE(pair.integers_are_true());
}

TEST(GnssNavigation, CrosslinkDataMayBeLateAndOutOfOrder) {
  CooperatingPair pair(8);
  CooperatingPair in_time(8);
  in_time.fly(30);
  // The target's epochs come two at a time, the later one first.
  for (int k = 0; k < 15; ++k) {
    const GpsTime first = pair.tag;
    const GpsTime second = first + duration_of_seconds(10);
    for (const GpsTime tag : {first, second}) {
      pair.tag = tag;
      pair.take(Receiver::kServicer);
      pair.navigation->update(tag, {});
    }
    pair.tag = second;
    pair.take(Receiver::kTarget);
    pair.tag = first;
    // The receiver's noise is drawn in order of the calls, so it differs from that of the pair in time.
    pair.take(Receiver::kTarget);
    pair.navigation->update(second, {});
    pair.tag = second + duration_of_seconds(10);
  }
  EXPECT_EQ(pair.navigation->counters().pairs, in_time.navigation->counters().pairs);
  EXPECT_EQ(pair.navigation->counters().alone, 0);
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

TEST(GnssNavigation, SilenceIsCoastedAndFixedAgain) {
  CooperatingPair pair(9);
  pair.fly(30);
  for (int k = 0; k < 60; ++k, pair.tag = pair.tag + duration_of_seconds(10)) {
    pair.take(Receiver::kServicer);
    pair.navigation->update(pair.tag, {});
  }
  EXPECT_GE(pair.navigation->counters().alone, 55);
  EXPECT_GE(seconds(pair.navigation->epoch() - pair.navigation->last_pair()), 550.0);
  const Matrix6 covariance = pair.navigation->covariance_rtn();
  const double variance = covariance(0, 0) + covariance(1, 1) + covariance(2, 2);
  EXPECT_GT(variance, 1e-6);  // it says so
  EXPECT_LT(pair.position_error(), 5.0 * std::sqrt(variance));
  pair.fly(20);
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

TEST(GnssNavigation, ASkyThatChangesAtOnce) {
  CooperatingPair pair(10);
  pair.fly(20);
  // All carriers begin anew with other integers.
  for (double& cycles : pair.target.cycles) cycles += 17.0 + (&cycles - pair.target.cycles.data());
  for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  pair.fly(1);
  EXPECT_LT(pair.position_error(), 5e-3);  // carried by the dynamics
  pair.fly(20);
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_TRUE(pair.integers_are_true());
}

TEST(GnssNavigation, HostileEpochsMoveNothing) {
  CooperatingPair pair(11);
  pair.fly(20);
  gnss::ObservationEpoch bad = pair.target.observe(pair.tag, pair.satellites, kEarth);
  for (std::size_t k = 0; k < bad.count; k += 3) bad.observations[k].pseudorange_m = NAN;
  for (std::size_t k = 1; k < bad.count; k += 3) bad.observations[k].carrier_phase_cycles = 1e300;
  for (std::size_t k = 2; k < bad.count; k += 3) bad.observations[k].pseudorange_m += 1e5;
  pair.take(Receiver::kServicer);
  pair.navigation->take(Receiver::kTarget, bad);
  pair.navigation->update(pair.tag, {});
  EXPECT_LT(pair.position_error(), 5e-3);
  EXPECT_EQ(pair.navigation->counters().restarts, 0);
  pair.tag = pair.tag + duration_of_seconds(10);
  pair.fly(20);
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

// The code that is processed first determines the clock of the epoch; wrong, it would make the filter refuse every
// phase.
TEST(GnssNavigation, AGrossErrorOfTheFirstCodeCostsThatCodeOnly) {
  CooperatingPair pair(14);
  pair.fly(20);
  ASSERT_TRUE(pair.navigation->ambiguities().is_fixed());
  gnss::ObservationEpoch multipath = pair.target.observe(pair.tag, pair.satellites, kEarth);
  multipath.observations[0].pseudorange_m += 20.0;
  pair.take(Receiver::kServicer);
  pair.navigation->take(Receiver::kTarget, multipath);
  pair.navigation->update(pair.tag, {});
  const RelativeUpdate& update = pair.navigation->last_update();
  EXPECT_EQ(update.codes_refused, 1);
  EXPECT_EQ(update.phases_refused, 0);
  EXPECT_GT(update.phases_used, 5);
  EXPECT_TRUE(pair.navigation->ambiguities().is_fixed());
  EXPECT_LT(pair.position_error(), 3e-3);
}

TEST(GnssNavigation, FewerThanFourSatellitesCoast) {
  CooperatingPair pair(12);
  pair.fly(20);
  const std::int32_t pairs = pair.navigation->counters().pairs;
  const std::vector<gnss::Ephemeris> all = pair.satellites;
  pair.satellites.resize(6);  // of six, three or fewer are in view
  pair.fly(10);
  EXPECT_EQ(pair.navigation->counters().pairs, pairs);
  EXPECT_GT(pair.navigation->counters().no_solution, 0);
  pair.satellites = all;
  pair.fly(20);
  EXPECT_TRUE(pair.integers_are_true());
  EXPECT_LT(pair.position_error(), 3e-3);
}

}  // namespace
}  // namespace vbar::fsw::navigation
