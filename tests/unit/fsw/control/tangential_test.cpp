// Tangential burns: the explicit three-burn optimum and the four-burn linear program.

#include "fsw/control/tangential.h"

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/unit/fsw/control/legs.h"

namespace vbar::fsw::control {
namespace {

namespace mission = orbit::mission;

TangentialTask task_of(const legs::Leg& leg, const NearCircularOrbit& orbit) {
  const ControlProblem problem = legs::problem(leg);
  return tangential_task(orbit, problem.pseudo_state, seconds(problem.arrival - problem.start));
}

PhaseTimes grid_of(const TangentialTask& task, const NearCircularOrbit& orbit) {
  const double phase = std::atan2(task.e_sin, task.e_cos) - eccentricity_phase(orbit, task.window, 0.0);
  return phase_times(phase, orbit.latitude_rate - orbit.perigee_rate, task.window);
}

// What burns do, summed as the definition of the task says.
Eigen::Vector4d done(const TangentialBurns& burns, const NearCircularOrbit& orbit, double window) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (std::size_t k = 0; k < burns.count; ++k) {
    const auto [offset, dv] = burns.impulses[k];
    const double phase = eccentricity_phase(orbit, window, offset);
    sum += dv * Eigen::Vector4d(1.0, window - offset, std::cos(phase), std::sin(phase));
  }
  return sum;
}

Eigen::Vector4d wanted(const TangentialTask& task) {
  return {task.sum, task.moment, task.e_cos, task.e_sin};
}

TEST(PhaseTimes, AreAllTimesAtThePhaseWithAlternatingParity) {
  const PhaseTimes times = phase_times(1.0, 2.0, 10.0);
  // 2 t = 1 + m pi, 0 <= t <= 10: m = 0 .. 6
  ASSERT_EQ(times.count, 7u);
  for (std::size_t m = 0; m < times.count; ++m) {
    EXPECT_NEAR(times.times[m].offset, (1.0 + static_cast<double>(m) * M_PI) / 2.0, 1e-14);
    EXPECT_EQ(times.times[m].parity, m % 2 == 0 ? 1.0 : -1.0);
  }
  EXPECT_EQ(phase_times(-1.0, 2.0, 0.5).count, 0u);  // (-1 + pi) / 2 is beyond
  EXPECT_EQ(phase_times(-1.0, 2.0, 1.1).times[0].parity, -1.0);
  EXPECT_EQ(phase_times(0.0, 1.0, 1e4).count, kMaxPhaseTimes);
}

TEST(ThreeBurns, MatchTheIndependentOptimaOfTheFarLegs) {
  for (const legs::Leg& leg : legs::kFarLegs) {
    const NearCircularOrbit orbit = near_circular_orbit(legs::problem(leg).servicer_mean);
    TangentialTask task = task_of(leg, orbit);
    const Result<TangentialBurns> burns = cheapest_three_burns(task, grid_of(task, orbit).all());
    ASSERT_TRUE(burns.ok()) << leg.from;
    // The table's solutions include the coupling with the normal burn, which shifts dlambda by up to 0.2 % and, for leg
    // 2 to 3 without an eccentricity change of its own, the phase.
    const double coupling = leg.from == 2 ? 0.05 : 0.004;
    EXPECT_NEAR(burns.value().cost(), leg.three_burns, coupling * leg.three_burns + 5e-5) << leg.from;
    // 1e-7 of a task of order 1 m/s and, in its moment, of its time to go.
    const Eigen::Vector4d miss = done(burns.value(), orbit, task.window) - wanted(task);
    EXPECT_LT(std::abs(miss[0]), 1e-7) << leg.from;
    EXPECT_LT(std::abs(miss[1]), 1e-7 * task.window) << leg.from;
    EXPECT_LT(std::hypot(miss[2], miss[3]), 1e-7) << leg.from;
  }
}

TEST(ThreeBurns, CostTheReachableBoundWhereDaOrDeRules) {
  for (const std::size_t index : {std::size_t{0}, std::size_t{3}}) {
    const NearCircularOrbit orbit = near_circular_orbit(legs::problem(legs::kFarLegs[index]).servicer_mean);
    const TangentialTask task = task_of(legs::kFarLegs[index], orbit);
    const ReachableBounds bounds =
        reachable_bounds(orbit, legs::problem(legs::kFarLegs[index]).pseudo_state, task.window);
    const Result<TangentialBurns> burns = cheapest_three_burns(task, grid_of(task, orbit).all());
    ASSERT_TRUE(burns.ok());
    EXPECT_NEAR(burns.value().cost(), bounds.in_plane(),
                1e-6 * bounds.in_plane());  // the optimality test of the theory
  }
}

TEST(ThreeBurns, NeedThreeTimesAndBothParities) {
  const TangentialTask task{.window = 100.0, .sum = 1.0, .moment = 2.0, .e_cos = 1.0, .e_sin = 0.0};
  const std::array<PhaseTime, 3> same{{{10.0, 1.0}, {20.0, 1.0}, {30.0, 1.0}}};
  EXPECT_EQ(cheapest_three_burns(task, same).status(), Status::kSingular);
  const std::array<PhaseTime, 2> two{{{10.0, 1.0}, {20.0, -1.0}}};
  EXPECT_EQ(cheapest_three_burns(task, two).status(), Status::kSingular);
}

// Slow and by another way: every basis of the linear program.
std::optional<double> brute_force(const NearCircularOrbit& orbit, const TangentialTask& task,
                                  const std::vector<double>& offsets) {
  std::optional<double> best;
  const auto column = [&](double offset) {
    const double phase = eccentricity_phase(orbit, task.window, offset);
    return Eigen::Vector4d(1.0, 1.0 - offset / task.window, std::cos(phase), std::sin(phase));
  };
  const Eigen::Vector4d rhs(task.sum, task.moment / task.window, task.e_cos, task.e_sin);
  for (std::size_t a = 0; a < offsets.size(); ++a)
    for (std::size_t b = a + 1; b < offsets.size(); ++b)
      for (std::size_t c = b + 1; c < offsets.size(); ++c)
        for (std::size_t d = c + 1; d < offsets.size(); ++d) {
          Eigen::Matrix4d basis;
          basis << column(offsets[a]), column(offsets[b]), column(offsets[c]), column(offsets[d]);
          const Eigen::FullPivLU<Eigen::Matrix4d> lu(basis);
          if (lu.rcond() < 1e-9) continue;
          const double cost = lu.solve(rhs).lpNorm<1>();
          if (!best || cost < *best) best = cost;
        }
  return best;
}

TEST(FourBurns, AreTheCheapestOfAllBases) {
  const NearCircularOrbit orbit = near_circular_orbit(mission::kServicerMean);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    const double window = 20000.0;
    const TangentialTask task{.window = window,
                              .sum = unit(random),
                              .moment = window * unit(random),
                              .e_cos = unit(random),
                              .e_sin = unit(random)};
    std::vector<double> offsets(12);
    for (double& offset : offsets) offset = 0.5 * window * (1.0 + unit(random));
    const Result<TangentialBurns> burns = cheapest_four_burns(orbit, task, offsets);
    ASSERT_TRUE(burns.ok()) << trial;
    const std::optional<double> expected = brute_force(orbit, task, offsets);
    ASSERT_TRUE(expected.has_value());
    EXPECT_NEAR(burns.value().cost(), *expected, 1e-8 * *expected) << trial;  // rounding of ill-conditioned 4x4 systems
    const Eigen::Vector4d miss = done(burns.value(), orbit, window) - wanted(task);
    EXPECT_LT(accuracy::largest_entry(miss.cwiseQuotient(Eigen::Vector4d(1.0, window, 1.0, 1.0))), 1e-9) << trial;
  }
}

TEST(FourBurns, ReachTheDenseOptimumOfTheDriftDominatedLegs) {
  for (const legs::Leg& leg : legs::kFarLegs) {
    const NearCircularOrbit orbit = near_circular_orbit(legs::problem(leg).servicer_mean);
    const TangentialTask task = task_of(leg, orbit);
    std::vector<double> dense;
    for (double offset = 0.0; offset <= task.window; offset += 60.0) dense.push_back(offset);
    const Result<TangentialBurns> burns = cheapest_four_burns(orbit, task, dense);
    ASSERT_TRUE(burns.ok()) << leg.from;
    // Coupling with the normal burn, which the table includes, as above; the table's grid is not known.
    EXPECT_NEAR(burns.value().cost(), leg.dense_optimum, 0.008 * leg.dense_optimum + 1e-4) << leg.from;
  }
}

TEST(FourBurns, FailWhereTheOffsetsCannotMeetTheTask) {
  const NearCircularOrbit orbit = near_circular_orbit(mission::kServicerMean);
  const TangentialTask task{.window = 1000.0, .sum = 0.1, .moment = 20.0, .e_cos = 0.3, .e_sin = -0.2};
  const std::vector<double> three = {0.0, 300.0, 900.0};
  EXPECT_EQ(cheapest_four_burns(orbit, task, three).status(), Status::kSingular);
  EXPECT_EQ(cheapest_four_burns(orbit, task, {}).status(), Status::kSingular);
}

}  // namespace
}  // namespace vbar::fsw::control
