#include "fsw/measurements/cdgnss/cdgnss_aiding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "tests/support/accuracy.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/measurements/cdgnss_pair.h"

namespace vbar::fsw::measurements {

namespace {

using test::FilterPair;
using test::kEarth;

TEST(CdgnssAiding, FixesWithinTwoMinutesAndFindsTheBaseline) {
  FilterPair pair(3);
  pair.fly_filter(12);
  ASSERT_EQ(pair.carrier->aid().state(), AidState::kAiding);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  // Phases of 0.7 mm, differenced, fourteen satellites: half a millimetre an axis; five of those.
  EXPECT_LT(pair.filter_position_error(), 3e-3);
  pair.fly_filter(60);
  EXPECT_LT(pair.filter_error().tail<3>().norm(), 2e-5);  // a millimetre over the minutes that velocity is averaged
  EXPECT_EQ(pair.carrier->counters().restarts, 0);
  EXPECT_EQ(pair.carrier->counters().phases_rejected, 0);
  EXPECT_EQ(pair.estimator->failures(), 0);
}

TEST(CdgnssAiding, EveryHeldIntegerIsTheTrueOneOverFiftySeeds) {
  int fixed = 0;
  constexpr int kSeeds = vbar::test::share_under_sanitizers(50);
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    FilterPair pair(seed, 5e-3, 1e-3);
    pair.servicer.code_sigma_m = pair.target.code_sigma_m = 0.8;
    pair.fly_filter(20);
    EXPECT_TRUE(pair.filter_integers_are_true()) << seed;
    fixed += pair.carrier->is_fixed() ? 1 : 0;
  }
  EXPECT_EQ(fixed, kSeeds);
}

// Normalised error squared of the six relative states, over seeds, against chi-square with 6 degrees of freedom a seed.
TEST(CdgnssAiding, IsConsistentWithItsErrors) {
  double nees = 0.0;
  double nis = 0.0;
  double nis_count = 0.0;
  constexpr int kSeeds = vbar::test::share_under_sanitizers(40);
  for (unsigned seed = 101; seed < 101 + kSeeds; ++seed) {
    // A vector of fixed length and random direction has length / sqrt(3) an axis, as the filter is configured.
    FilterPair pair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3);
    pair.expect_no_acceleration();
    for (int k = 0; k < 40; ++k) {
      pair.fly_filter(1);
      if (k < 20) continue;
      nis += pair.carrier->last_update().phase_nis;
      nis_count += pair.carrier->last_update().phases_used;
    }
    // The filter stands at the last tag.
    const Vector6 error = pair.filter_error();
    nees += error.dot(pair.filter_covariance().inverse() * error);
  }
  // 95 % of its mean: 6 +- 1.96 sqrt(12 / seeds).
  EXPECT_NEAR(nees / kSeeds, 6.0, 1.96 * std::sqrt(12.0 / kSeeds));
  EXPECT_NEAR(nis / nis_count, 1.0, 0.05 * std::sqrt(40.0 / kSeeds));
}

TEST(CdgnssAiding, ASlipReportedByTheReceiversIsCorrectedAtOnce) {
  FilterPair pair(5);
  pair.fly_filter(15);
  for (std::size_t k = 0; k < 60; k += 7) {
    pair.target.cycles[k] += 3.0;
    pair.target.lock_start_s[k] = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  }
  pair.fly_filter(1);
  EXPECT_GT(pair.carrier->counters().slips, 0);
  EXPECT_LT(pair.filter_position_error(), 3e-3);
  pair.fly_filter(10);
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

TEST(CdgnssAiding, ASlipThatIsNotReportedIsFound) {
  for (const double cycles : {1.0, -1.0, 5.0, 1000.0}) {
    FilterPair pair(6);
    pair.fly_filter(15);
    const std::size_t place = 2U * (pair.carrier->filter().channels()[0].satellite.prn - 1U);
    pair.target.cycles[place] += cycles;
    pair.fly_filter(1);
    EXPECT_EQ(pair.carrier->counters().slips, 1) << cycles;
    EXPECT_LT(pair.filter_position_error(), 3e-3) << cycles;
    pair.fly_filter(10);
    EXPECT_TRUE(pair.filter_integers_are_true()) << cycles;
  }
}

/// One of the integers held is wrong by a cycle, and the estimate with it: what a false fix leaves behind.
void falsify_integer(FilterPair& pair, std::size_t place, double cycles) {
  const double wavelength = gnss::wavelength(pair.carrier->filter().channels()[place].signal);
  pair.estimator->estimate().shift(CarrierFilter::ambiguity_index(place), cycles * wavelength);
}

/// What the source reports as inconsistent in the next `epochs`, and how many of these pass until it does.
int epochs_until_reported(FilterPair& pair, int epochs) {
  for (int k = 1; k <= epochs; ++k) {
    pair.carrier->aid().forget_inconsistency();
    pair.fly_filter(1);
    if (pair.carrier->aid().inconsistency()) return k;
  }
  return epochs + 1;
}

// Required: reported within 300 s, the error below 10 cm throughout, corrected within 600 s.
TEST(CdgnssAiding, AnIntegerThatIsWrongByOneCycleIsReportedAndCorrected) {
  for (const unsigned seed : {6U, 7U, 8U}) {
    for (const std::size_t falsified : {1U, 3U, 6U, 9U}) {
      FilterPair pair(seed);
      pair.fly_filter(20);
      ASSERT_TRUE(pair.carrier->is_fixed());
      ASSERT_FALSE(pair.carrier->aid().inconsistency());
      for (std::size_t k = 0; k < falsified; ++k) falsify_integer(pair, k, 1.0);
      EXPECT_FALSE(pair.filter_integers_are_true()) << seed;
      EXPECT_LE(epochs_until_reported(pair, 30), 30) << seed << ' ' << falsified;
      accuracy::Largest error_m;
      for (int k = 0; k < 30; ++k) {
        pair.fly_filter(1);
        error_m.add(pair.filter_position_error());
      }
      EXPECT_LT(error_m, 0.1) << seed << ' ' << falsified;
      EXPECT_TRUE(pair.carrier->is_fixed()) << seed << ' ' << falsified;
      EXPECT_TRUE(pair.filter_integers_are_true()) << seed << ' ' << falsified;
      EXPECT_LT(pair.filter_position_error(), 3e-3) << seed << ' ' << falsified;
    }
  }
}

/// An antenna ten times as far from its nominal place as configured: a solution that is fixed, and wrong by many of its
/// sigmas, until the offsets that the dynamics ask for exceed their own sigma. An offset along the track (x here) is an
/// orbit as well: no receiver can see it.
TEST(CdgnssAiding, AnAntennaThatIsNotWhereItIsAssumedIsReportedAndAllowedFor) {
  for (const int axis : {1, 2}) {
    FilterPair pair(21);
    pair.expect_no_acceleration();
    pair.target.antenna_body_m += 10.0 * 3.2e-3 * std::sqrt(3.0) * Vector3::Unit(axis);
    const double sigma_m = pair.carrier->filter().antenna_sigma_m();
    EXPECT_LE(epochs_until_reported(pair, 120), 120) << axis;
    EXPECT_EQ(pair.carrier->report().releases, 1) << axis;
    // d = 55 mm over the sigma of a difference, 3.2 mm sqrt(2), is 12.2: the sigma grows to between the threshold, as
    // the estimate passes it, and d / sqrt(2), of which the offset is one sigma.
    const double growth = pair.carrier->filter().antenna_sigma_m() / sigma_m;
    EXPECT_GT(growth, CdgnssAiding::kMaxAntennaMisfit) << axis;
    EXPECT_LT(growth, 10.0 * std::sqrt(3.0) / std::sqrt(2.0)) << axis;
    // Consistent from then on, and fixed again: 99.9 % of chi-square with six degrees of freedom.
    for (int k = 0; k < 4; ++k) {
      pair.fly_filter(10);
      const Vector6 error = pair.filter_error();
      EXPECT_LT(error.dot(pair.filter_covariance().inverse() * error), 22.5) << axis << ' ' << k;
    }
    EXPECT_TRUE(pair.carrier->is_fixed()) << axis;
    EXPECT_EQ(pair.estimator->failures(), 0) << axis;
  }
}

/// The dynamics observe the difference of both antennas, of which each is given half: 30 mm are 6.6 sigma of the
/// difference, 3.2 mm sqrt(2), although either half is 4.7 of its own; 12 mm are 2.7.
TEST(CdgnssAiding, AnOffsetIsJudgedByTheDifferenceOfBothAntennas) {
  for (const double offset_m : {0.012, 0.03}) {
    FilterPair pair(22);
    pair.expect_no_acceleration();
    pair.target.antenna_body_m += offset_m * Vector3::Unit(2);
    const bool is_reported = epochs_until_reported(pair, 200) < 200;
    EXPECT_EQ(is_reported, offset_m > 4.5 * std::sqrt(2.0) * 3.2e-3) << offset_m;
  }
}

// At 5 ms the orbit has moved on by 37 m between the tag and the reception.
TEST(CdgnssAiding, ClocksMayStandMillisecondsApart) {
  FilterPair pair(13);
  pair.servicer.clock_s = 5e-3;
  pair.target.clock_s = -5e-3;
  pair.fly_filter(20);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
  EXPECT_EQ(pair.carrier->counters().restarts, 0);
}

/// The target is suddenly elsewhere, and its phases are acquired again.
void displace_target(FilterPair& pair) {
  pair.target.start.position_eci += orbit::R_rtn_eci(pair.target.start).transpose() * Vector3(0.0, 300.0, 0.0);
  for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
}

TEST(CdgnssAiding, AnOwnOrbitThatTheCodesContradictIsInitialisedAgain) {
  FilterPair pair(14);
  pair.fly_filter(20);
  displace_target(pair);
  pair.fly_filter(20);
  EXPECT_EQ(pair.carrier->counters().restarts, 1);
  EXPECT_EQ(pair.carrier->counters().failures, 1);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

TEST(CdgnssAiding, AnOrbitOfAnotherSourceIsNeverInitialisedAgain) {
  FilterPair pair(14);
  pair.fly_filter(20);
  pair.carrier->share_orbit();
  const Vector6 error = pair.filter_error();
  displace_target(pair);
  const double displaced = 300.0;
  pair.fly_filter(20);
  EXPECT_EQ(pair.carrier->counters().restarts, 0);
  EXPECT_EQ(pair.carrier->counters().failures, 1);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kFailed);
  EXPECT_EQ(pair.estimator->solution_status(), filter::SolutionStatus::kEstimated);
  EXPECT_NEAR(pair.filter_position_error(), displaced, 30.0) << error.transpose();
  // Its own blocks are inactive, and no others.
  EXPECT_FALSE(filter::is_active<ServicerAntenna>(pair.estimator->estimate()));
  EXPECT_FALSE(filter::is_active<CodeBiases>(pair.estimator->estimate()));
  EXPECT_FALSE(filter::is_active<filter::EmpiricalAcceleration>(pair.estimator->estimate()));
  EXPECT_FALSE(filter::is_active<ClockDifference>(pair.estimator->estimate()));
  for (std::size_t k = 0; k < kPhaseChannels; ++k) {
    EXPECT_TRUE(pair.estimator->estimate().is_inactive(CarrierFilter::ambiguity_index(k)));
  }
  EXPECT_TRUE(filter::is_active<filter::Roe>(pair.estimator->estimate()));
  EXPECT_TRUE(filter::is_active<filter::DifferentialAccelerations>(pair.estimator->estimate()));
}

/// A relative orbit as of another source: the true one, displaced along track, with sigmas of 10 m and 10 mm/s.
void begin_as_another_source(FilterPair& pair, double displaced_m) {
  const orbit::CartesianState servicer = pair.estimator->servicer();
  const orbit::CartesianState true_servicer = pair.servicer.state_at(pair.estimator->epoch());
  orbit::CartesianState target = pair.target.state_at(pair.estimator->epoch());
  target.position_eci +=
      servicer.position_eci - true_servicer.position_eci + displaced_m * orbit::R_rtn_eci(servicer).row(1).transpose();
  target.velocity_eci += servicer.velocity_eci - true_servicer.velocity_eci;
  const auto roe = orbit::roe_of_target(servicer, target);
  const auto jacobian = roe_from_target_jacobian(servicer, target);
  ASSERT_TRUE(roe.ok() && jacobian.ok());
  Vector6 variance;
  variance << Vector3::Constant(100.0), Vector3::Constant(1e-4);
  pair.estimator->initialize_relative(roe.value(),
                                      jacobian.value() * variance.asDiagonal() * jacobian.value().transpose(),
                                      filter::SolutionStatus::kEstimated);
}

TEST(CdgnssAiding, JoinsAnOrbitThatAgreesAfterThreeEpochs) {
  FilterPair pair(15);
  pair.fly_alone(20);
  begin_as_another_source(pair, 5.0);
  pair.fly_filter(2);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kStarting);
  pair.fly_filter(15);
  EXPECT_EQ(pair.carrier->counters().starts, 0);
  EXPECT_FALSE(pair.carrier->owns_orbit());
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

TEST(CdgnssAiding, DoesNotJoinAnOrbitThatDisagrees) {
  FilterPair pair(15);
  pair.fly_alone(20);
  begin_as_another_source(pair, 300.0);
  pair.fly_filter(10);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kStarting);
  EXPECT_EQ(pair.carrier->counters().pairs, 0);
  EXPECT_FALSE(filter::is_active<ServicerAntenna>(pair.estimator->estimate()));
}

TEST(CdgnssAiding, BurnsAreFollowed) {
  FilterPair pair(7);
  pair.fly_filter(20);
  // A burn 4 s after the last epoch, as large as they come at close range.
  const GpsTime burn_time = pair.estimator->epoch() + duration_of_seconds(4);
  const Vector3 dv_rtn(0.002, -0.003, 0.001);
  const orbit::CartesianState after = orbit::apply_impulse_rtn(pair.servicer.state_at(burn_time), dv_rtn);
  // Back to the start in the same field, with the Earth's orientation at the burn.
  const filter::Propagation back(burn_time, kEarth, Vector3::UnitX());
  pair.servicer.start = back.coast(after, -seconds(burn_time - test::start_time()));
  const std::array<filter::Burn, 1> burns{{{burn_time, dv_rtn}}};
  pair.step(burns);
  EXPECT_LT(pair.filter_position_error(), 3e-3);
  EXPECT_LT(pair.filter_error().tail<3>().norm(), 5e-5);
  EXPECT_TRUE(pair.filter_integers_are_true());
}

/// The receivers track on while the crosslink is silent: their lock times at its end state that the integers hold.
TEST(CdgnssAiding, SilenceIsCoastedAndEndsWithTheIntegersOfBefore) {
  FilterPair pair(9);
  pair.fly_filter(30);
  const GpsTime last = *pair.carrier->last_pair();
  const std::int32_t fixes = pair.carrier->report().fixes;
  pair.fly_alone(60);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kSuspended);
  EXPECT_EQ(*pair.carrier->last_pair(), last);
  const double variance = pair.filter_covariance().topLeftCorner<3, 3>().trace();
  EXPECT_GT(variance, 1e-6);
  EXPECT_LT(pair.filter_position_error(), 5.0 * std::sqrt(variance));
  pair.fly_filter(1);
  EXPECT_EQ(pair.carrier->counters().starts, 1);
  EXPECT_EQ(pair.carrier->report().fixes, fixes);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

/// After an hour, or where the receivers lost their locks, they are determined again.
TEST(CdgnssAiding, ALongSilenceIsCoastedAndFixedAgain) {
  FilterPair pair(9);
  pair.fly_filter(30);
  pair.fly_alone(30);
  for (double& cycles : pair.target.cycles) cycles += 17.0 + static_cast<double>(&cycles - pair.target.cycles.data());
  for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  pair.fly_filter(20);
  EXPECT_EQ(pair.carrier->counters().starts, 1);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

struct SilentBurn {
  int silence_s = 0;
  double dv_mps = 0.0;
  bool keeps_lock = true;
};

class UnreportedBurn : public testing::TestWithParam<SilentBurn> {};

/// The servicer burns at the beginning of the silence, without a report.
void burn_unreported(FilterPair& pair, const Vector3& dv_rtn) {
  const GpsTime burn_time = pair.estimator->epoch() + duration_of_seconds(4);
  const orbit::CartesianState after = orbit::apply_impulse_rtn(pair.servicer.state_at(burn_time), dv_rtn);
  const filter::Propagation back(burn_time, kEarth, Vector3::UnitX());
  pair.servicer.start = back.coast(after, -seconds(burn_time - test::start_time()));
}

// Required: no valid estimate is wrong by more than five sigma for longer than three epochs after the silence, and what
// was found is reported.
TEST_P(UnreportedBurn, IsFoundWithinThreeEpochsAndReported) {
  const SilentBurn& burn = GetParam();
  for (const int axis : {0, 1, 2}) {
    FilterPair pair(31U + static_cast<unsigned>(axis));
    pair.fly_filter(30);
    burn_unreported(pair, burn.dv_mps * Vector3::Unit(axis));
    pair.fly_alone(burn.silence_s / 10);
    if (!burn.keeps_lock) {
      for (double& cycles : pair.target.cycles) {
        cycles += 17.0 + static_cast<double>(&cycles - pair.target.cycles.data());
      }
      for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
    }
    EXPECT_LE(epochs_until_reported(pair, 3), 3) << axis;
    for (int k = 0; k < 60; ++k) {
      pair.fly_filter(1);
      const double sigma_m = std::sqrt(pair.filter_covariance().topLeftCorner<3, 3>().trace());
      ASSERT_LT(pair.filter_position_error(), 5.0 * sigma_m) << axis << ' ' << k;
    }
    EXPECT_TRUE(pair.carrier->is_fixed()) << axis;
    EXPECT_TRUE(pair.filter_integers_are_true()) << axis;
    EXPECT_LT(pair.filter_position_error(), 5e-3) << axis;
  }
}

INSTANTIATE_TEST_SUITE_P(OutagesAndSizes, UnreportedBurn,
                         testing::Values(SilentBurn{60, 1e-3}, SilentBurn{300, 1e-3}, SilentBurn{1200, 20e-3},
                                         SilentBurn{300, 0.3e-3}, SilentBurn{300, 1e-3, false},
                                         SilentBurn{900, 5e-3, false}));

TEST(CdgnssAiding, AShortSilenceKeepsTheIntegers) {
  FilterPair pair(9);
  pair.fly_filter(30);
  const std::int32_t fixes = pair.carrier->report().fixes;
  pair.fly_alone(8);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kSuspended);
  pair.fly_filter(1);
  EXPECT_EQ(pair.carrier->aid().state(), AidState::kAiding);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_EQ(pair.carrier->report().fixes, fixes);
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

TEST(CdgnssAiding, ASkyThatChangesAtOnce) {
  FilterPair pair(10);
  pair.fly_filter(20);
  // All carriers are acquired again, with other integers.
  for (double& cycles : pair.target.cycles) cycles += 17.0 + static_cast<double>(&cycles - pair.target.cycles.data());
  for (double& lock : pair.target.lock_start_s) lock = 1000.0 + seconds(pair.tag - test::start_time()) - 1.0;
  pair.fly_filter(1);
  EXPECT_LT(pair.filter_position_error(), 5e-3);  // carried by the dynamics
  pair.fly_filter(20);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_TRUE(pair.filter_integers_are_true());
}

TEST(CdgnssAiding, HostileEpochsMoveNothing) {
  FilterPair pair(11);
  pair.fly_filter(20);
  gnss::ObservationEpoch bad = pair.target.observe(pair.tag, pair.satellites, kEarth);
  for (std::size_t k = 0; k < bad.count; k += 3) bad.observations[k].pseudorange_m = NAN;
  for (std::size_t k = 1; k < bad.count; k += 3) bad.observations[k].carrier_phase_cycles = 1e300;
  for (std::size_t k = 2; k < bad.count; k += 3) bad.observations[k].pseudorange_m += 1e5;
  pair.step(pair.servicer.observe(pair.tag, pair.satellites, kEarth), &bad);
  EXPECT_LT(pair.filter_position_error(), 5e-3);
  EXPECT_EQ(pair.carrier->counters().restarts, 0);
  pair.tag = pair.tag + duration_of_seconds(10);
  pair.fly_filter(20);
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

// The code that is processed first determines the clock of the epoch; a wrong one would cause all phases to be refused.
TEST(CdgnssAiding, AGrossErrorOfTheFirstCodeCostsThatCodeOnly) {
  FilterPair pair(14);
  pair.fly_filter(20);
  ASSERT_TRUE(pair.carrier->is_fixed());
  gnss::ObservationEpoch multipath = pair.target.observe(pair.tag, pair.satellites, kEarth);
  multipath.observations[0].pseudorange_m += 20.0;
  pair.step(pair.servicer.observe(pair.tag, pair.satellites, kEarth), &multipath);
  const CarrierUpdate& update = pair.carrier->last_update();
  EXPECT_EQ(update.codes_rejected, 1);
  EXPECT_EQ(update.phases_rejected, 0);
  EXPECT_GT(update.phases_used, 5);
  EXPECT_TRUE(pair.carrier->is_fixed());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

TEST(CdgnssAiding, FewerThanFourSatellitesCoast) {
  FilterPair pair(12);
  pair.fly_filter(20);
  const std::int32_t pairs = pair.carrier->counters().pairs;
  const std::vector<gnss::Ephemeris> all = pair.satellites;
  pair.satellites.resize(6);  // of six, three or fewer are in view
  pair.fly_filter(10);
  EXPECT_EQ(pair.carrier->counters().pairs, pairs);
  EXPECT_GT(pair.own->counters().no_solution, 0);
  pair.satellites = all;
  pair.fly_filter(20);
  EXPECT_TRUE(pair.filter_integers_are_true());
  EXPECT_LT(pair.filter_position_error(), 3e-3);
}

}  // namespace

// Navigation of a cooperating pair whose carrier phases have a time-correlated error: consistency, and the integers.

namespace {

/// A pair whose receivers wander by `true_mm`, and a filter that is configured for `configured_mm`, over 60 s.
FilterPair wandering_pair(unsigned seed, double true_mm, double configured_mm) {
  FilterPair pair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3);
  for (gnss::test::SyntheticReceiver* receiver : {&pair.servicer, &pair.target})
    receiver->wander_sigma_m = 1e-3 * true_mm;
  // Of a single difference: two receivers.
  pair.filter_settings.processes.of<PhaseWander>() = {.sigma = std::sqrt(2.0) * 1e-3 * configured_mm, .time_s = 60.0};
  pair.expect_no_acceleration();
  return pair;
}

struct Statistics {
  double nees = 0.0;  ///< mean over seeds
  double nis = 0.0;   ///< mean over phases
  int fixed = 0;
  int with_wrong_integers = 0;
  int releases = 0;
};

Statistics fly(int seeds, int epochs, double true_mm, double configured_mm) {
  Statistics all;
  double nis_count = 0.0;
  for (int seed = 201; seed < 201 + seeds; ++seed) {
    FilterPair pair = wandering_pair(static_cast<unsigned>(seed), true_mm, configured_mm);
    bool integers_are_true = true;
    for (int k = 0; k < epochs; ++k) {
      pair.fly_filter(1);
      integers_are_true = integers_are_true && pair.filter_integers_are_true();
      if (k < epochs / 2) continue;
      all.nis += pair.carrier->last_update().phase_nis;
      nis_count += pair.carrier->last_update().phases_used;
    }
    const Vector6 error = pair.filter_error();
    all.nees += error.dot(pair.filter_covariance().inverse() * error) / seeds;
    all.fixed += pair.carrier->is_fixed() ? 1 : 0;
    all.with_wrong_integers += integers_are_true ? 0 : 1;
    all.releases += pair.carrier->report().releases;
  }
  all.nis /= nis_count;
  return all;
}

constexpr int kWanderSeeds = vbar::test::share_under_sanitizers(40);
// 95 % of chi-square(6 x 40) / 40.
const double kNeesBand = 1.96 * std::sqrt(12.0 / kWanderSeeds);

TEST(PhaseWanderAiding, IsConsistentWhereItIsConfigured) {
  for (const double wander_mm : {0.5, 1.0, 2.0}) {
    const Statistics all = fly(kWanderSeeds, 40, wander_mm, wander_mm);
    EXPECT_NEAR(all.nees, 6.0, kNeesBand) << wander_mm;
    EXPECT_NEAR(all.nis, 1.0, 0.05 * std::sqrt(40.0 / kWanderSeeds)) << wander_mm;  // as in IsConsistentWithItsErrors
    EXPECT_EQ(all.with_wrong_integers, 0) << wander_mm;
    EXPECT_EQ(all.fixed, kWanderSeeds) << wander_mm;
    EXPECT_EQ(all.releases, 0) << wander_mm;
  }
}

// The same wander taken for white noise: the integers contradict what the covariance allows.
TEST(PhaseWanderAiding, IsNotConsistentWhereItIsNot) {
  if (vbar::test::kAddressSanitizer) GTEST_SKIP() << "statistics of 40 seeds";
  const Statistics all = fly(kWanderSeeds, 40, 2.0, 0.0);
  EXPECT_GT(all.nees, 6.0 + 4.0 * kNeesBand);
  EXPECT_GT(all.nis, 1.5);
  EXPECT_LT(all.fixed, kWanderSeeds);
}

TEST(PhaseWanderAiding, AMismatchHoldsNoWrongInteger) {
  struct Mismatch {
    double true_mm, configured_mm;
  };
  for (const Mismatch mismatch : {Mismatch{1.0, 0.5}, Mismatch{0.5, 1.0}, Mismatch{0.0, 1.0}}) {
    const Statistics all = fly(kWanderSeeds, 40, mismatch.true_mm, mismatch.configured_mm);
    EXPECT_EQ(all.with_wrong_integers, 0) << mismatch.true_mm << " mm, configured " << mismatch.configured_mm;
    EXPECT_EQ(all.fixed, kWanderSeeds) << mismatch.true_mm << " mm, configured " << mismatch.configured_mm;
  }
}

}  // namespace

}  // namespace vbar::fsw::measurements
