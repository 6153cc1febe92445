#include "host_sim/truth/integration/dopri5.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "host_sim/truth/integration/event_location.h"
#include "tests/support/accuracy.h"

namespace vbar::truth {

namespace {

using Vector1 = Eigen::Matrix<double, 1, 1>;
using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector4 = Eigen::Matrix<double, 4, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

template <int N, class Rhs>
Dopri5<N, Rhs> integrator(Rhs rhs, double relative, double absolute) {
  typename Dopri5<N, Rhs>::Tolerance tolerance;
  tolerance.relative.setConstant(relative);
  tolerance.absolute.setConstant(absolute);
  return Dopri5<N, Rhs>(rhs, tolerance);
}

/// Arenstorf's periodic orbit in the restricted three-body problem (Hairer, Norsett, Wanner 1993, eq. II.0.1).
Vector4 arenstorf(double, const Vector4& y) {
  constexpr double kMu = 0.012277471, kMuPrime = 1.0 - kMu;
  const double r1 = std::hypot(y[0] + kMu, y[1]), r2 = std::hypot(y[0] - kMuPrime, y[1]);
  const double d1 = r1 * r1 * r1, d2 = r2 * r2 * r2;
  return {y[2], y[3], y[0] + 2.0 * y[3] - kMuPrime * (y[0] + kMu) / d1 - kMu * (y[0] - kMuPrime) / d2,
          y[1] - 2.0 * y[2] - kMuPrime * y[1] / d1 - kMu * y[1] / d2};
}

const Vector4 kArenstorfStart(0.994, 0.0, 0.0, -2.00158510637908252240537862224);
constexpr double kArenstorfPeriod = 17.0652165601579625588917206249;

TEST(Dopri5, TakesTheStepsOfHairersProgramOnArenstorfsOrbit) {
  // Hairer's DOPRI5 demonstration prints 216 accepted steps and 1442 calls at 1e-7. The other rows come from a second
  // program (in another language) with the same controller; their counts may differ by a step or two where an error
  // estimate, a small difference of large numbers, falls on either side of 1 by rounding. Errors grow along this
  // unstable orbit: 20 %.
  struct Row {
    double tolerance;
    int steps, steps_margin;
    double error, error_margin;
  };
  for (const Row& row : {Row{1e-7, 216, 0, 1.48e-3, 0.005e-3}, Row{1e-10, 841, 0, 2.6e-6, 0.05e-6},
                         Row{1e-12, 2113, 2, 3.1e-8, 0.62e-8}}) {
    auto solver = integrator<4>(arenstorf, row.tolerance, row.tolerance);
    solver.start(0.0, kArenstorfStart);
    solver.integrate_to(kArenstorfPeriod);
    EXPECT_NEAR(static_cast<double>(solver.statistics().accepted_steps), row.steps, row.steps_margin);
    const double error = (solver.state() - kArenstorfStart).norm();
    if (row.tolerance == 1e-7) {
      accuracy::expect_count("Dormand-Prince on Arenstorf's orbit, accepted steps at 1e-7", "Hairer's DOPRI5, printed",
                             solver.statistics().accepted_steps, 216, "steps");
      accuracy::expect_count("Dormand-Prince on Arenstorf's orbit, evaluations at 1e-7", "Hairer's DOPRI5, printed",
                             solver.statistics().evaluations, 1442, "evaluations");
    }
    EXPECT_NEAR(error, row.error, row.error_margin) << row.tolerance;
    char tolerance[16];
    std::snprintf(tolerance, sizeof tolerance, "%g", row.tolerance);
    accuracy::expect_below(std::string("Dormand-Prince on Arenstorf's orbit, error at the end at ") + tolerance,
                           "the orbit is closed; a second program's error, its margin added", error,
                           row.error + row.error_margin, "");
    EXPECT_EQ(solver.time(), kArenstorfPeriod);
  }
}

constexpr double kGm = 3.986004415e14;

Vector6 two_body(double, const Vector6& y) {
  Vector6 rate;
  const double r = y.head<3>().norm();
  rate << y.tail<3>(), -kGm / (r * r * r) * y.head<3>();
  return rate;
}

Vector6 circular_orbit(double radius) {
  Vector6 y;
  const double speed = std::sqrt(kGm / radius);
  y << radius, 0.0, 0.0, 0.0, 0.6 * speed, 0.8 * speed;
  return y;
}

TEST(Dopri5, TwoBodyOrbitsReturnToTheirStart) {
  // 15 orbits of a low circular orbit in Cartesian coordinates, where the printed errors of another program with the
  // same method are 0.14 m, 1.9 cm and 6 mm; the exact solution is the start. Half again as much for another
  // orientation and first step.
  constexpr double kRadius = 7.0e6;
  const double period = 2.0 * M_PI * std::sqrt(kRadius * kRadius * kRadius / kGm);
  for (const auto& [tolerance, error] : {std::pair{1e-11, 0.14}, {1e-12, 1.9e-2}, {1e-13, 6e-3}}) {
    auto solver = integrator<6>(two_body, tolerance, 1e-6 * tolerance / 1e-12);
    const Vector6 start = circular_orbit(kRadius);
    solver.start(0.0, start);
    solver.integrate_to(15.0 * period);
    char text[64];
    std::snprintf(text, sizeof text, "at a tolerance of %g", tolerance);
    accuracy::expect_below(std::string("two bodies, 15 low orbits, position ") + text, "Kepler: the start",
                           (solver.state() - start).head<3>().norm(), 1.5 * error, "m");
    const auto energy = [](const Vector6& y) { return 0.5 * y.tail<3>().squaredNorm() - kGm / y.head<3>().norm(); };
    // 1 m in position along track comes from about 1e-8 / 90 of energy per radian; a tenth of the position's error
    // bounds it.
    accuracy::expect_below(std::string("two bodies, 15 low orbits, energy ") + text, "conservation",
                           std::abs(energy(solver.state()) / energy(start) - 1.0), 0.1 * error / kRadius, "relative");
  }
}

TEST(Dopri5, ForwardAndBackToTheStart) {
  const Vector6 start = circular_orbit(7.0e6);
  auto forward = integrator<6>(two_body, 1e-12, 1e-6);
  forward.start(0.0, start);
  forward.integrate_to(20000.0);
  auto back = integrator<6>(two_body, 1e-12, 1e-6);
  back.start(20000.0, forward.state(), -1.0);
  back.integrate_to(0.0);
  EXPECT_EQ(back.time(), 0.0);
  accuracy::expect_below("two bodies, 20,000 s forward and back", "the start", (back.state() - start).head<3>().norm(),
                         5e-3,
                         "m");  // twice 3.5 orbits' share of 1.9 cm in 15
}

Vector2 oscillator(double, const Vector2& y) {
  return {y[1], -y[0]};
}

/// Largest error over a turn of the oscillator in `steps` equal steps: at the ends, and inside the steps.
std::pair<double, double> oscillator_errors(int steps) {
  auto solver = integrator<2>(oscillator, 0.0, 1e3);  // a tolerance that never shortens a step
  solver.start(0.0, Vector2(1.0, 0.0));
  accuracy::Largest at_ends, inside;
  const auto error = [](double t, const Vector2& y) { return (y - Vector2(std::cos(t), -std::sin(t))).norm(); };
  for (int i = 1; i <= steps; ++i) {
    solver.integrate_to(2.0 * M_PI * i / steps);
    at_ends.add(error(solver.time(), solver.state()));
    // The interpolant's own error: the one of the step's start removed.
    for (double part : {0.2, 0.4, 0.6, 0.8}) {
      const double t = solver.last_step().start + part * solver.last_step().size;
      inside.add(error(t, solver.last_step()(t)));
    }
  }
  EXPECT_EQ(solver.statistics().accepted_steps, steps);
  return {at_ends, inside};
}

TEST(Dopri5, IsOfOrderFiveAndItsDenseOutputToo) {
  // Halving the step divides the global error by 2^5 = 32, and the dense output of order 4, whose error over one step
  // is of order h^5, keeps the rate. 20 % for the next order's terms at steps of 1/80 and 1/160 of a turn.
  const auto [ends_80, inside_80] = oscillator_errors(80);
  const auto [ends_160, inside_160] = oscillator_errors(160);
  accuracy::expect_below("Dormand-Prince is of order 5: error over that of half the step",
                         "2^5, the harmonic oscillator", std::abs(ends_80 / ends_160 - 32.0), 6.4, "from 32");
  accuracy::expect_below("its dense output of order 4: error inside one step over that of half the step",
                         "2^5, the harmonic oscillator", std::abs(inside_80 / inside_160 - 32.0), 6.4, "from 32");
}

TEST(Dopri5, DenseOutputMeetsTheStepsAndTheirSlopes) {
  auto solver = integrator<2>(oscillator, 1e-8, 1e-8);
  solver.start(0.0, Vector2(1.0, 0.0));
  for (int i = 0; i < 20; ++i) {
    const Vector2 before = solver.state();
    solver.step();
    const DenseStep<2>& step = solver.last_step();
    EXPECT_EQ(step(step.start), before);
    EXPECT_LT((step(solver.time()) - solver.state()).norm(), 1e-15);
    // Central differences at the ends: error of order d^2 = 1e-10 times the third derivative, rounding 1e-16/d.
    const double d = 1e-5;
    const Vector2 slope = (step(step.start + d) - step(step.start - d)) / (2.0 * d);
    EXPECT_LT((slope - oscillator(0.0, before)).norm(), 1e-9);
    const Vector2 end_slope = (step(solver.time() + d) - step(solver.time() - d)) / (2.0 * d);
    EXPECT_LT((end_slope - oscillator(0.0, solver.state())).norm(), 1e-9);
  }
}

TEST(Dopri5, StopsAtEventsAndGoesOnFromThere) {
  // cos t changes sign at pi/2 + k pi. The event is located to 1e-6 on a solution good to 1e-10.
  const auto position = [](double, const Vector2& y) { return y[0]; };
  for (double direction : {1.0, -1.0}) {
    auto solver = integrator<2>(oscillator, 1e-11, 1e-11);
    solver.start(0.0, Vector2(1.0, 0.0), direction);
    for (int k = 0; k < 3; ++k) {
      while (!solver.step_to_event(position, direction * 100.0, 4, 1e-6)) {
      }
      EXPECT_NEAR(solver.time(), direction * (M_PI / 2.0 + k * M_PI), 1.1e-6);
      EXPECT_NEAR(solver.state()[0], std::cos(solver.time()), 1e-9);
    }
  }
}

TEST(Dopri5, ACutStepIsARungeKuttaStep) {
  auto whole = integrator<2>(oscillator, 1e-10, 1e-10);
  whole.start(0.0, Vector2(1.0, 0.0));
  while (whole.time() < 1.0) whole.step();
  whole.cut_last_step(1.0);
  EXPECT_EQ(whole.time(), 1.0);
  EXPECT_LT((whole.state() - Vector2(std::cos(1.0), -std::sin(1.0))).norm(), 1e-9);  // tens of steps of 1e-10
  EXPECT_THROW(whole.cut_last_step(1.1), std::invalid_argument);
  EXPECT_THROW(whole.cut_last_step(0.0), std::invalid_argument);
}

TEST(Dopri5, AStepCutShortByALimitDoesNotShortenTheNext) {
  auto free = integrator<2>(oscillator, 1e-10, 1e-10), limited = integrator<2>(oscillator, 1e-10, 1e-10);
  free.start(0.0, Vector2(1.0, 0.0));
  limited.start(0.0, Vector2(1.0, 0.0));
  for (int i = 0; i < 20; ++i) {
    free.step();
    limited.step();
  }
  const double usual = free.last_step().size;
  limited.step(limited.time() + 1e-3 * usual);
  EXPECT_NEAR(limited.last_step().size, 1e-3 * usual, 1e-12);
  limited.step();
  EXPECT_GT(limited.last_step().size, 0.8 * usual);  // the oscillator's steps vary by a tenth over a turn
}

TEST(Dopri5, RestartAfterAJumpIsANewProblem) {
  // At t = 1 the velocity is reversed: the motion runs back to the start.
  auto solver = integrator<2>(oscillator, 1e-11, 1e-11);
  solver.start(0.0, Vector2(1.0, 0.0));
  solver.integrate_to(1.0);
  solver.restart(Vector2(solver.state()[0], -solver.state()[1]));
  solver.integrate_to(2.0);
  EXPECT_LT((solver.state() - Vector2(1.0, 0.0)).norm(), 1e-9);
}

TEST(Dopri5, RefusesTolerancesThatDoublesCannotHold) {
  EXPECT_THROW(integrator<2>(oscillator, 1e-15, 0.0), std::invalid_argument);
  EXPECT_THROW(integrator<2>(oscillator, 0.0, 0.0), std::invalid_argument);
  EXPECT_THROW(integrator<2>(oscillator, -1e-9, 1e-9), std::invalid_argument);
  EXPECT_THROW(integrator<2>(oscillator, std::nan(""), 1e-9), std::invalid_argument);
  EXPECT_THROW(integrator<2>(oscillator, 1e-9, INFINITY), std::invalid_argument);
  EXPECT_NO_THROW(integrator<2>(oscillator, 3e-15, 0.0));
}

TEST(Dopri5, StopsWithAnErrorAtASingularity) {
  // y' = y^2, y(0) = 1 is 1/(1-t): infinite at t = 1.
  auto solver = integrator<1>([](double, const Vector1& y) { return Vector1(y[0] * y[0]); }, 1e-9, 1e-9);
  solver.start(0.0, Vector1(1.0));
  EXPECT_THROW(solver.integrate_to(2.0), std::runtime_error);
  EXPECT_LT(solver.time(), 1.0 + 1e-6);
  EXPECT_THROW(solver.integrate_to(0.0), std::invalid_argument);
}

}  // namespace

namespace {

TEST(EventLocation, FindsTheFirstChangeInEitherDirection) {
  const auto g = [](double t) { return std::sin(t); };
  EXPECT_NEAR(first_sign_change(g, 1.0, 10.0, 30, 1e-9).value(), M_PI, 2e-9);
  EXPECT_NEAR(first_sign_change(g, 10.0, 1.0, 30, 1e-9).value(), 3.0 * M_PI, 2e-9);
  EXPECT_FALSE(first_sign_change(g, 0.5, 3.0, 30, 1e-9).has_value());
}

TEST(EventLocation, ReturnsTheFarSideAndDoesNotFindAnEventTwice) {
  const auto g = [](double t) { return t * t * t - 2.0; };
  const double found = first_sign_change(g, 0.0, 3.0, 1, 1e-6).value();
  EXPECT_GE(g(found), 0.0);
  EXPECT_NEAR(found, std::cbrt(2.0), 1e-6);
  EXPECT_FALSE(first_sign_change(g, found, 3.0, 10, 1e-6).has_value());
  // A zero exactly at the start is an event already dealt with.
  EXPECT_FALSE(first_sign_change([](double t) { return t; }, 0.0, 1.0, 10, 1e-6).has_value());
  // A zero exactly at a sample is found there.
  EXPECT_EQ(first_sign_change([](double t) { return t - 0.5; }, 0.0, 1.0, 2, 1e-6).value(), 0.5);
}

TEST(EventLocation, RefusesNonsense) {
  const auto g = [](double t) { return t - 0.3; };
  EXPECT_THROW(first_sign_change(g, 0.0, 1.0, 0, 1e-6), std::invalid_argument);
  EXPECT_THROW(first_sign_change(g, 0.0, 1.0, 1, 0.0), std::invalid_argument);
  EXPECT_THROW(first_sign_change([](double) { return std::nan(""); }, 0.0, 1.0, 1, 1e-6), std::invalid_argument);
}

TEST(EventLocation, AtTheStartTheFunctionCountsAsPositive) {
  // An edge just located, whose function is still a little negative by rounding: not an exit.
  const auto rising = [](double t) { return t - 1e-9; };
  EXPECT_FALSE(first_exit(rising, 0.0, 1.0, 2, 1e-6).has_value());
  // But one that stays on the wrong side is left at once.
  const auto falling = [](double t) { return -1e-9 - t; };
  EXPECT_NEAR(first_exit(falling, 0.0, 1.0, 2, 1e-6).value(), 0.0, 1e-6);
}

TEST(EventLocation, FollowsADipBetweenSamplesToItsBottom) {
  // A parabola negative for `width` around any place between three samples, either way in time; found half to one
  // resolution beyond, and rounding.
  for (double width : {0.1, 1e-3, 1e-5}) {
    for (double centre : {0.07, 0.31, 0.48, 0.62, 0.9}) {
      const auto g = [&](double t) { return (t - centre) * (t - centre) - 0.25 * width * width; };
      EXPECT_NEAR(first_exit(g, 0.0, 1.0, 2, 1e-9).value(), centre - 0.5 * width, 1.001e-9);
      EXPECT_NEAR(first_exit(g, 1.0, 0.0, 2, 1e-9).value(), centre + 0.5 * width, 1.001e-9);
    }
  }
}

TEST(EventLocation, ADipThatDoesNotReachZeroIsNone) {
  const auto g = [](double t) { return (t - 0.4) * (t - 0.4) + 1e-9; };
  EXPECT_FALSE(first_exit(g, 0.0, 1.0, 2, 1e-6).has_value());
}

}  // namespace

}  // namespace vbar::truth
