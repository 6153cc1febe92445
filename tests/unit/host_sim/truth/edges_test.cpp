// Steps that end where a force jumps: at the shadow's edges and at dates.

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::orbit::CartesianState;
using test::dynamics_with;
using test::fly;
using test::InertialJ2;
using test::list;
using test::same_bits;
using test::servicer_state;
using test::sunlight;

constexpr double kDay = 86400.0;

/// A force whose edges the propagator is not told of: it switches by itself, in the middle of steps.
class Unannounced final : public Force {
 public:
  explicit Unannounced(std::unique_ptr<Force> force) : force_(std::move(force)) {}
  std::string_view name() const override { return force_->name(); }
  bool needs_sun_and_moon() const override { return force_->needs_sun_and_moon(); }
  Vector3 acceleration_eci(const ForceInput& input) override {
    for (int edge = 0; edge < force_->edge_count(); ++edge) force_->set_side(edge, force_->edge(edge, input) > 0.0);
    return force_->acceleration_eci(input);
  }

 private:
  std::unique_ptr<Force> force_;
};

/// What a test's force was told.
struct Log {
  std::vector<double> crossings;  ///< time of the first call after each change of side
  std::vector<double> intervals;  ///< each interval entered
};

/// A push along the velocity, forwards where a function of time is positive and backwards elsewhere.
class Switch final : public Force {
 public:
  Switch(std::function<double(double)> function, Log* log) : function_(std::move(function)), log_(log) {}
  std::string_view name() const override { return "switch"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    if (changed_) log_->crossings.push_back(input.seconds);
    changed_ = false;
    return input.velocity_eci.normalized() * (positive_ ? 1e-6 : -1e-6);
  }
  int edge_count() const override { return 1; }
  double edge(int, const ForceInput& input) const override { return function_(input.seconds); }
  void set_side(int, bool positive) override {
    changed_ = positive != positive_;
    positive_ = positive;
  }

 private:
  std::function<double(double)> function_;
  Log* log_;
  bool positive_ = true;
  bool changed_ = false;
};

/// A push along the velocity that changes its sign at every multiple of a period.
class Alternating final : public Force {
 public:
  Alternating(double period, double push, Log* log = nullptr) : period_(period), push_(push), log_(log) {}
  std::string_view name() const override { return "alternating"; }
  Vector3 acceleration_eci(const ForceInput& input) override { return sign_ * push_ * input.velocity_eci.normalized(); }
  double next_jump_after(double seconds) const override { return period_ * (std::floor(seconds / period_) + 1.0); }
  void enter_interval(double seconds) override {
    sign_ = std::fmod(std::floor(seconds / period_), 2.0) == 0.0 ? 1.0 : -1.0;
    if (log_ != nullptr) log_->intervals.push_back(seconds);
  }

 private:
  double period_, push_;
  Log* log_;
  double sign_ = 1.0;
};

double distance(const CartesianState& a, const CartesianState& b) {
  return (a.position_eci - b.position_eci).norm();
}

TEST(Edges, LocatedTheErrorFallsWithTheToleranceUnannouncedItDoesNot) {
  // A day with J2 and the cylinder's 30 edges, against steps of 2 s. A local error of `tolerance` times the orbit's
  // size a in a grows along track by 3/2 n t = 137, and errors of a thousand steps average: 30 a times tolerance is
  // allowed. Left alone, the integrator's error estimates are shaken by the jumps and the result is worse tenfold and
  // more.
  const CartesianState reference =
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical), std::make_unique<Alternating>(2.0, 0.0)),
          1e-13, kDay);
  for (double tolerance : {1e-10, 1e-11, 1e-12, 1e-13}) {
    const double allowed = 30.0 * 7.1e6 * tolerance;
    const double located =
        distance(fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)), tolerance, kDay), reference);
    const double unannounced = distance(
        fly(list(std::make_unique<InertialJ2>(), std::make_unique<Unannounced>(sunlight(Shadow::kCylindrical))),
            tolerance, kDay),
        reference);
    EXPECT_LT(located, allowed) << tolerance;
    EXPECT_GT(unannounced, 10.0 * allowed) << tolerance;
    if (tolerance == 1e-13) {
      accuracy::expect_below("one day through a cylindrical shadow's edges, tolerance 1e-13", "steps of 2 s", located,
                             allowed, "m");
    }
  }
}

TEST(Edges, OfThePenumbraCostNoAccuracyEither) {
  // The mission's orbit flies over the terminator and grazes the penumbra; allowed as above.
  const CartesianState reference =
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical), std::make_unique<Alternating>(0.5, 0.0)),
          1e-12, kDay);
  for (double tolerance : {1e-10, 1e-11, 1e-12, 1e-13}) {
    const double allowed = 30.0 * 7.1e6 * tolerance;
    const double located =
        distance(fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical)), tolerance, kDay), reference);
    EXPECT_LT(located, allowed) << tolerance;
    if (tolerance == 1e-13) {
      accuracy::expect_below("one day through a conical shadow's penumbra, tolerance 1e-13", "steps of 0.5 s", located,
                             allowed, "m");
    }
  }
}

TEST(Edges, CostAFewSteps) {
  IntegrationStatistics lit, shadowed;
  fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kNone)), 1e-13, kDay, &lit);
  fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)), 1e-13, kDay, &shadowed);
  const double orbits = kDay / 5938.0;
  RecordProperty("steps_per_orbit_lit", std::to_string(static_cast<double>(lit.accepted_steps) / orbits));
  RecordProperty("steps_per_orbit_shadowed", std::to_string(static_cast<double>(shadowed.accepted_steps) / orbits));
  // Two edges an orbit, each of which divides one step into two; the step size is kept.
  EXPECT_LT(static_cast<double>(shadowed.accepted_steps - lit.accepted_steps), 2.0 * orbits);
  // The step up to an edge is taken twice, six evaluations, and one begins the next.
  EXPECT_LT(static_cast<double>(shadowed.evaluations - lit.evaluations), 2.0 * orbits * (6.0 + 6.0 + 1.0));
}

/// Cowell's method in pieces of 10 s, a piece in which an edge's sign changes cut by bisection of its length.
CartesianState cowell_with_edges(SpacecraftDynamics& dynamics, CartesianState state, double end) {
  dynamics.enter_regime_of(0.0, state);
  const auto crossed = [&](double t, const CartesianState& at) {
    for (int edge = 0; edge < dynamics.edge_count(); ++edge) {
      if ((dynamics.edge(edge, t, at) > 0.0) != dynamics.regime().sides[static_cast<std::size_t>(edge)]) return edge;
    }
    return -1;
  };
  double t = 0.0;
  while (t < end) {
    double piece = std::min(10.0, end - t);
    CartesianState next = test::cowell(dynamics, state, t, t + piece);
    int edge = crossed(t + piece, next);
    if (edge >= 0) {
      double before = 0.0;
      while (piece - before > 1e-6) {
        const double middle = 0.5 * (before + piece);
        const CartesianState at_middle = test::cowell(dynamics, state, t, t + middle);
        const int edge_at_middle = crossed(t + middle, at_middle);
        if (edge_at_middle < 0) {
          before = middle;
        } else {
          edge = edge_at_middle;
          piece = middle;
          next = at_middle;
        }
      }
      dynamics.cross_edge(edge, t + piece, next);
    }
    t += piece;
    state = next;
  }
  return state;
}

TEST(Edges, AgainstCowellOverALeg) {
  // Six hours with J2, Sun, Moon and sunlight through the cylinder, off the terminator so that each orbit is eclipsed.
  // 1 mm is the claim of a leg.
  fsw::orbit::QnsElements elements = test::servicer_elements();
  elements.raan += 1.0;
  const CartesianState start = orbit_geometry(elements, test::kGm).state;
  const auto dynamics = [] {
    return dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical),
                              std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun),
                              std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon)));
  };
  SpacecraftPropagator propagator(dynamics(), 1e-13, 0.0, start);
  propagator.advance_to(21600.0);
  EXPECT_GE(propagator.edges_crossed(), 7);
  const auto peer = dynamics();
  const CartesianState expected = cowell_with_edges(*peer, start, 21600.0);
  accuracy::expect_below("six hours with J2, Sun, Moon and sunlight, seven shadow edges",
                         "Cowell's method, Fehlberg 7(8), edges by bisection", distance(propagator.state(), expected),
                         1e-3, "m");
}

/// Sunlight from where the Sun is seen: behind its place by the aberration, 20.5 arcsec along its yearly path.
class LateSun final : public Force {
 public:
  explicit LateSun(std::unique_ptr<Force> force) : force_(std::move(force)) {}
  std::string_view name() const override { return force_->name(); }
  bool needs_sun_and_moon() const override { return true; }
  Vector3 acceleration_eci(const ForceInput& input) override { return force_->acceleration_eci(late(input)); }
  int edge_count() const override { return force_->edge_count(); }
  double edge(int index, const ForceInput& input) const override { return force_->edge(index, late(input)); }
  void set_side(int index, bool positive) override { force_->set_side(index, positive); }

 private:
  static ForceInput late(ForceInput input) {
    constexpr double kObliquity = 23.44 * test::kDegree, kAberration = 20.5 / 3600.0 * test::kDegree;
    const Vector3 ecliptic_pole(0.0, -std::sin(kObliquity), std::cos(kObliquity));
    input.sun_eci -= kAberration * ecliptic_pole.cross(input.sun_eci);
    return input;
  }
  std::unique_ptr<Force> force_;
};

TEST(Edges, AberrationIsLeftOutForLittle) {
  // What sun_moon.h says is left out, and how much that is for the mission's servicer over a day: 1e-4 of a force that
  // moves it by 9 m.
  const CartesianState as_it_is =
      fly(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)), 1e-13, kDay);
  const CartesianState as_seen =
      fly(list(std::make_unique<InertialJ2>(), std::make_unique<LateSun>(sunlight(Shadow::kCylindrical))), 1e-13, kDay);
  const CartesianState dark = fly(list(std::make_unique<InertialJ2>()), 1e-13, kDay);
  RecordProperty("effect_of_sunlight_m", std::to_string(distance(as_it_is, dark)));
  accuracy::expect_below("aberration of sunlight left out, one day of the servicer", "the Sun 20.5 arcsec late",
                         distance(as_it_is, as_seen), 1e-3, "m");
}

TEST(Edges, AreWhereARootSearchOnAnotherTrajectoryFindsThem) {
  // Kepler's motion (the light's push is set to nothing), its edges bisected in time.
  Log log;
  class Told final : public Force {
   public:
    explicit Told(Log* log) : log_(log) {}
    std::string_view name() const override { return "told"; }
    bool needs_sun_and_moon() const override { return true; }
    Vector3 acceleration_eci(const ForceInput& input) override {
      if (changed_) log_->crossings.push_back(input.seconds);
      changed_ = false;
      return Vector3::Zero();
    }
    int edge_count() const override { return 1; }
    double edge(int, const ForceInput& input) const override {
      return cylindrical_shadow_edge(input.position_eci, input.sun_eci, {});
    }
    void set_side(int, bool) override { changed_ = true; }

   private:
    Log* log_;
    bool changed_ = false;
  };
  fsw::orbit::QnsElements elements = test::servicer_elements();
  elements.raan += 1.0;  // off the terminator
  SpacecraftPropagator propagator(dynamics_with(list(std::make_unique<Told>(&log))), 1e-13, 0.0,
                                  orbit_geometry(elements, test::kGm).state);
  propagator.advance_to(40000.0);
  // The first change logged is the start's, and the last step may reach beyond the end.
  std::vector<double> found(log.crossings.begin() + 1, log.crossings.end());
  std::erase_if(found, [](double t) { return t > 40000.0; });

  const double mean_motion = std::sqrt(test::kGm / elements.a) / elements.a;
  const auto edge = [&](double seconds) {
    fsw::orbit::QnsElements now = elements;
    now.u += mean_motion * seconds;
    return cylindrical_shadow_edge(orbit_geometry(now, test::kGm).state.position_eci,
                                   sun_moon_series(tt_of(test::mission_epoch(), seconds)).sun_eci, {});
  };
  std::vector<double> roots;
  for (double t = 0.0; t < 40000.0; t += 10.0) {
    double low = t, high = t + 10.0;
    if ((edge(low) > 0.0) == (edge(high) > 0.0)) continue;
    for (int i = 0; i < 60; ++i)
      ((edge(0.5 * (low + high)) > 0.0) == (edge(low) > 0.0) ? low : high) = 0.5 * (low + high);
    roots.push_back(low);
  }
  ASSERT_EQ(found.size(), roots.size());
  ASSERT_GE(roots.size(), 13u);  // 6.7 orbits
  accuracy::Largest largest;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    largest.add(std::abs(found[i] - roots[i]));
  }
  accuracy::expect_below("shadow edges located", "bisection on Kepler's motion, 13 edges", largest, 1e-6, "s");
}

TEST(Edges, ShortVisitsAreFound) {
  // A function of the orbit's period that is negative for `duration`, as when a shadow is grazed, at times that fall
  // anywhere in steps as long as Kepler's motion allows, and as short as the full gravity field's.
  const double turn = 2.0 * M_PI * 1.001;  // not quite the orbit's, so that each visit meets its steps elsewhere
  constexpr double kPeriod = 5938.0;
  for (double longest_step : {1e9, 40.0}) {
    for (double duration : {20.0, 5.0, 1.0, 0.1}) {
      Log log;
      const auto dip = [&](double t) {
        return 7e6 * (std::cos(0.5 * duration * turn / kPeriod) - std::cos(turn * (t - 1000.0) / kPeriod));
      };
      fly(list(std::make_unique<Switch>(dip, &log), std::make_unique<Alternating>(longest_step, 0.0)), 1e-12,
          20.0 * kPeriod);
      std::vector<double> expected;
      for (int k = 0; k < 20; ++k) {
        const double centre = 1000.0 + k * kPeriod / 1.001;
        expected.push_back(centre - 0.5 * duration);
        expected.push_back(centre + 0.5 * duration);
      }
      // 1e-6 s, and for the shortest visit the roundings of a cosine near 1 over its slope: 1e-16 / 5e-8.
      EXPECT_THAT(log.crossings, testing::Pointwise(testing::DoubleNear(1e-6), expected)) << duration;
    }
  }
}

TEST(Edges, OfSeveralForcesInOneStep) {
  Log a, b;
  const auto at = [](double when) { return [when](double t) { return when - t; }; };
  fly(list(std::make_unique<Switch>(at(100.0), &a), std::make_unique<Switch>(at(99.999), &b),
           std::make_unique<Alternating>(50.0, 1e-6)),
      1e-12, 1000.0);
  ASSERT_THAT(a.crossings, testing::SizeIs(1));
  ASSERT_THAT(b.crossings, testing::SizeIs(1));
  EXPECT_NEAR(a.crossings[0], 100.0, 1e-6);  // at a date that ends a step as well
  EXPECT_NEAR(b.crossings[0], 99.999, 1e-6);
}

TEST(Jumps, EndStepsAtTheirDates) {
  Log log;
  fly(list(std::make_unique<Alternating>(700.0, 1e-6, &log)), 1e-12, 2500.0);
  EXPECT_THAT(log.intervals, testing::ElementsAre(0.0, 700.0, 1400.0, 2100.0));
}

TEST(Jumps, DoNotSpoilTheOrder) {
  // A push of 1e-6 m/s^2 (0.5 km along track a day) that turns over every 700 s, against steps of a tenth of that.
  const auto flight = [](double tolerance, double steps) {
    return fly(list(std::make_unique<Alternating>(700.0, 1e-6), std::make_unique<Alternating>(steps, 0.0)), tolerance,
               kDay);
  };
  const CartesianState reference = flight(1e-14, 7.0);
  for (double tolerance : {1e-10, 1e-12}) {
    EXPECT_LT(distance(flight(tolerance, 1e9), reference), 30.0 * 7.1e6 * tolerance);  // as for edges
  }
}

TEST(Jumps, TimesAskedForDoNotChangeABit) {
  const auto propagator = [] {
    return std::make_unique<SpacecraftPropagator>(
        dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kConical),
                           std::make_unique<Alternating>(700.0, 1e-6),
                           std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon))),
        1e-13, 0.0, servicer_state());
  };
  const auto in_one_go = propagator(), irregular = propagator();
  in_one_go->advance_to(20000.0);
  for (double t = 0.123; t < 20000.0; t += 17.3) {
    irregular->advance_to(t);
    static_cast<void>(irregular->accelerations());  // a table asks for forces elsewhere than the integrator stands
  }
  irregular->advance_to(20000.0);
  EXPECT_TRUE(same_bits(in_one_go->state(), irregular->state()));
  EXPECT_GT(in_one_go->edges_crossed(), 4);
}

TEST(Jumps, AnImpulseBeforeThemTakesTheStepAgainAsItWas) {
  // An impulse of nothing at many times about an edge and a date, in the step that ended there or the one after. The
  // forces of the wrong side for a step of 50 s would move the spacecraft along track by 1e-6 * 50 * 3 * 1000 = 0.15 m;
  // the two solutions differ by local errors, 1e-12 of 7e6 m, ten steps.
  Log log;
  const auto forces = [&log] {
    return list(std::make_unique<Switch>([](double t) { return 500.0 - t; }, &log),
                std::make_unique<Alternating>(600.0, 1e-6));
  };
  const CartesianState expected = fly(forces(), 1e-12, 1500.0);
  for (double t = 440.0; t < 660.0; t += 4.0) {
    SpacecraftPropagator propagator(dynamics_with(forces()), 1e-12, 0.0, servicer_state());
    propagator.advance_to(t);
    propagator.apply_impulse_rtn(Vector3::Zero());
    propagator.advance_to(1500.0);
    EXPECT_LT(distance(propagator.state(), expected), 1e-4) << t;
  }
}

}  // namespace
}  // namespace vbar::truth
