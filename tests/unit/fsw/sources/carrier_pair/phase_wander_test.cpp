// Navigation of a cooperating pair whose carrier phases have a time-correlated error: consistency, and the integers.

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/sources/carrier_pair/trunk_pair.h"

namespace vbar::fsw::sources {
namespace {

using test::FilterPair;

/// A pair whose receivers wander by `true_mm`, and a filter that is configured for `configured_mm`, over 60 s.
FilterPair wandering_pair(unsigned seed, double true_mm, double configured_mm) {
  FilterPair pair(seed, 3.2e-3 * std::sqrt(3.0), 1e-3);
  for (navigation::test::SyntheticReceiver* receiver : {&pair.servicer, &pair.target})
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
      pair.fly_trunk(1);
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
}  // namespace vbar::fsw::sources
