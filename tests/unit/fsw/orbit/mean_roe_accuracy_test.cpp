// How well mean ROE and their J2 drift describe the real relative motion: against six hours of point mass and J2
// integrated slowly, from the same osculating states. The bounds are what an independent implementation of the same
// theory reached.

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/secular.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {
namespace {

CartesianState cartesian_from_mean(const QnsElements& mean) {
  return cartesian_from_qns(osculating_from_mean(mean).value()).value();
}

QnsElements mean_from_cartesian(const CartesianState& state) {
  return mean_from_osculating(qns_from_cartesian(state).value()).value();
}

/// Largest errors of a * ROE, m, over six hours, every ten minutes.
struct Errors {
  Vector6 linear = Vector6::Zero();   ///< of the transition matrix
  Vector6 secular = Vector6::Zero();  ///< of both mean orbits moved on by their own rates
};

Errors errors_over_six_hours(const Vector6& roe) {
  const QnsElements chief_mean = mission::kServicerMean;
  const QnsElements deputy_mean = qns_from_roe(chief_mean, roe);
  CartesianState chief = cartesian_from_mean(chief_mean);
  CartesianState deputy = cartesian_from_mean(deputy_mean);
  Errors worst;
  for (int k = 1; k <= 36; ++k) {
    chief = reference::fly(chief, 600.0);
    deputy = reference::fly(deputy, 600.0);
    const double t = 600.0 * k;
    const Vector6 truth = roe_from_qns(mean_from_cartesian(chief), mean_from_cartesian(deputy));
    const Vector6 linear = roe_transition_j2(chief_mean, t) * roe;
    const Vector6 secular = roe_from_qns(propagate_secular(chief_mean, t), propagate_secular(deputy_mean, t));
    worst.linear = worst.linear.cwiseMax(chief_mean.a * (linear - truth).cwiseAbs());
    worst.secular = worst.secular.cwiseMax(chief_mean.a * (secular - truth).cwiseAbs());
  }
  return worst;
}

TEST(MeanRoeAccuracy, AtFiftyKilometresIsBelowAMetre) {
  Vector6 roe;
  roe << 0.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0;
  const Vector6 error = errors_over_six_hours(roe / mission::kReferenceA).linear;
  EXPECT_LT(error(0), 0.33);
  EXPECT_LT(error(1), 0.25);
  EXPECT_LT(error(2), 0.32);
  EXPECT_LT(error(3), 0.33);
  EXPECT_LT(std::hypot(error(4), error(5)), 0.026);
}

TEST(MeanRoeAccuracy, AtTenMetresIsATenthOfAMillimetre) {
  const Vector6 error = errors_over_six_hours(mission::kWaypoints[8].roe()).linear;
  for (int k = 0; k < 6; ++k) EXPECT_LT(error(k), 1.5e-4) << "ROE " << k;
}

TEST(MeanRoeAccuracy, FarAwayAsksForTwoOrbitsInsteadOfOneMatrix) {
  // Waypoint 0: 75 km and closing. The matrix loses 24 m along track, the nonlinear secular motion 0.3 m.
  const Errors errors = errors_over_six_hours(mission::kWaypoints[0].roe());
  EXPECT_NEAR(errors.linear(1), 24.0, 1.0);
  EXPECT_LT(errors.secular(1), 0.5);
}

TEST(MeanRoeAccuracy, RelativePositionIsPredictedThroughTheOsculatingOrbits) {
  // From waypoint 8, six hours on: the mean ROE moved by the matrix, mapped back to RTN about the true servicer.
  const QnsElements chief_mean = mission::kServicerMean;
  const Vector6 roe = mission::kWaypoints[8].roe();
  CartesianState chief = cartesian_from_mean(chief_mean);
  CartesianState deputy = cartesian_from_mean(qns_from_roe(chief_mean, roe));
  for (int k = 1; k <= 12; ++k) {
    chief = reference::fly(chief, 1800.0);
    deputy = reference::fly(deputy, 1800.0);
    const Vector3 truth = relative_state_rtn(chief, deputy).position_rtn;
    const Vector6 drifted = roe_transition_j2(chief_mean, 1800.0 * k) * roe;
    const Vector3 predicted = relative_state_from_mean_roe(mean_from_cartesian(chief), drifted).value().position_rtn;
    EXPECT_LT((predicted - truth).norm(), 5e-4);  // a tenth of a millimetre of each ROE, twice in T, in three axes
  }
}

}  // namespace
}  // namespace vbar::fsw::orbit
