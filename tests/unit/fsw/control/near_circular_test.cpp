// Rates and reachable-set bounds against the numbers of an independent implementation.

#include "fsw/control/near_circular.h"

#include <gtest/gtest.h>

#include "tests/unit/fsw/control/legs.h"

namespace vbar::fsw::control {
namespace {

namespace mission = orbit::mission;

TEST(NearCircularOrbit, RatesOfTheMissionOrbit) {
  const NearCircularOrbit orbit = near_circular_orbit(mission::kServicerMean);
  // Koenig, Guffanti and D'Amico's transition matrix evaluated by hand for this orbit; all digits given are right.
  EXPECT_NEAR(orbit.n, 1.06020601e-3, 5e-12);
  EXPECT_NEAR(orbit.drift_rate, 1.58571e-3, 5e-9);
  const double kepler_period = 5926.3815;
  EXPECT_NEAR(orbit.perigee_rate * kepler_period / mission::kDegree, -0.2133, 5e-5);
  EXPECT_NEAR(orbit.node_drift_rate * 1000.0 * 3600.0, 4.93, 5e-3);  // m/h of a diy per km of a dix
  const double nodal_period = 5933.571;
  EXPECT_NEAR(orbit.latitude_rate, math::kTwoPi / nodal_period, 1e-9);  // period given to 0.5 ms of 5933 s
}

TEST(ReachableBounds, OfTheFarLegs) {
  for (const legs::Leg& leg : legs::kFarLegs) {
    const ControlProblem problem = legs::problem(leg);
    const NearCircularOrbit orbit = near_circular_orbit(problem.servicer_mean);
    const ReachableBounds bounds =
        reachable_bounds(orbit, problem.pseudo_state, seconds(problem.arrival - problem.start));
    const double rounding = 1.5e-4;  // the table has four decimals, its inputs three of metres
    EXPECT_NEAR(bounds.da, leg.bound_da, rounding) << leg.from;
    EXPECT_NEAR(bounds.de, leg.bound_de, rounding) << leg.from;
    EXPECT_NEAR(bounds.dlambda, leg.bound_dlambda, rounding) << leg.from;
    EXPECT_DOUBLE_EQ(bounds.in_plane(), std::max({bounds.da, bounds.de, bounds.dlambda}));
  }
}

TEST(ReachableBounds, InclinationCostsTheSpeedTimesItsChange) {
  const NearCircularOrbit orbit = near_circular_orbit(mission::kServicerMean);
  Vector6 change = Vector6::Zero();
  change[4] = 3e-4;
  change[5] = -4e-4;
  // n a |di|, circular orbit.
  EXPECT_NEAR(reachable_bounds(orbit, change, 6000.0).di, 7078138.944 * 1.06020601e-3 * 5e-4, 1e-7);
}

TEST(EccentricityPhase, OneOrbitOnTurnsByOneTurnLessThePerigeeDrift) {
  const NearCircularOrbit orbit = near_circular_orbit(mission::kServicerMean);
  const double first = eccentricity_phase(orbit, 20000.0, 1000.0);
  const double anomalistic_period = math::kTwoPi / (orbit.latitude_rate - orbit.perigee_rate);
  EXPECT_NEAR(eccentricity_phase(orbit, 20000.0, 1000.0 + anomalistic_period) - first, math::kTwoPi, 1e-9);
}

}  // namespace
}  // namespace vbar::fsw::control
